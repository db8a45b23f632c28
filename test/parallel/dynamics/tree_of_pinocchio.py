"""The tree of a parallel robot in Pinocchio, its loops closed by Lagrange's multipliers."""

import numpy as np
import pinocchio

__all__ = ["TreeOfPinocchio"]


class TreeOfPinocchio:
    """Accelerations and efforts of a mechanism from its URDF, by coordinates of all its joints.

    ``M qdd + h = S tau + A' x``, ``A qdd = -dA/dt qd``: A is the difference of the Jacobians of the
    frames in which the limbs end, S takes the drives.  Nothing of it is ours but the URDF.
    """

    def __init__(self, mechanism, gravity=(0.0, 0.0, -9.81)):
        self.mechanism = mechanism
        self.model = pinocchio.buildModelFromXML(mechanism.urdf())
        self.model.gravity.linear = np.array(gravity)
        self.order = [self.model.getJointId(name) for name in mechanism.joint_names]
        drives = [drive for limb in mechanism.limbs for drive in limb.chain.drives]
        self.rates = np.array([self.model.joints[i].idx_v for i in self.order])
        armature = np.zeros(self.model.nv)
        armature[self.rates] = [drive.reflected_inertia for drive in drives]
        self.model.armature = armature
        self.data = self.model.createData()
        links = [limb.chain.tip for limb in mechanism.limbs]
        self.ends = [self.model.getFrameId(link, pinocchio.FrameType.BODY) for link in links]

    def posture(self, q):
        """Joint values as Pinocchio has them, joints without limits as points of a circle."""
        found = np.zeros(self.model.nq)
        for i, value in zip(self.order, q, strict=True):
            joint = self.model.joints[i]
            if joint.nq == 2:
                found[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
            else:
                found[joint.idx_q] = value
        return found

    def equations(self, q, qd):
        """M (n, n), h (n,), A (c, n) and dA/dt qd (c,), joints in the order of the mechanism."""
        at, rates = self.posture(q), np.zeros(self.model.nv)
        rates[self.rates] = qd
        frame = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        M = pinocchio.crba(self.model, self.data, at).copy()
        M = np.triu(M) + np.triu(M, 1).T
        h = pinocchio.nonLinearEffects(self.model, self.data, at, rates).copy()
        pinocchio.computeJointJacobians(self.model, self.data, at)
        pinocchio.forwardKinematics(self.model, self.data, at, rates, np.zeros(self.model.nv))
        pinocchio.updateFramePlacements(self.model, self.data)
        jacobians, drifts = [], []
        for end in self.ends:
            jacobians.append(pinocchio.getFrameJacobian(self.model, self.data, end, frame).copy())
            drift = pinocchio.getFrameClassicalAcceleration(self.model, self.data, end, frame)
            drifts.append(np.concatenate((drift.linear, drift.angular)))
        A = np.concatenate([one - jacobians[0] for one in jacobians[1:]])
        drift = np.concatenate([one - drifts[0] for one in drifts[1:]])
        own = self.rates
        return M[np.ix_(own, own)], h[own], A[:, own], drift

    def forward(self, q, qd, efforts):
        """Accelerations of all joints (n,) and the multipliers, for efforts of the drives."""
        M, h, A, drift = self.equations(q, qd)
        n, c = len(q), len(A)
        force = -h
        force[self.mechanism.drive_index] += efforts
        whole = np.block([[M, -A.T], [A, np.zeros((c, c))]])
        found = np.linalg.lstsq(whole, np.concatenate((force, -drift)), rcond=1e-13)[0]
        return found[:n], found[n:]

    def inverse(self, q, qd, qdd):
        """Efforts of the drives for accelerations of all joints that keep the loops closed."""
        M, h, A, _ = self.equations(q, qd)
        index = self.mechanism.drive_index
        take = np.concatenate((np.eye(len(q))[:, index], A.T), axis=1)
        return np.linalg.lstsq(take, M @ qdd + h, rcond=1e-13)[0][: len(index)]

    def state(self, q, qd, efforts):
        """Posture, rates and efforts of all joints as Pinocchio's own functions take them."""
        rates, tau = np.zeros(self.model.nv), np.zeros(self.model.nv)
        rates[self.rates] = qd
        tau[self.rates[self.mechanism.drive_index]] = efforts
        return self.posture(q), rates, tau

    def contacts(self):
        """The welds that close the loops, as rigid constraints of Pinocchio."""
        frames = [self.model.frames[end] for end in self.ends]
        kind, local = pinocchio.ContactType.CONTACT_6D, pinocchio.ReferenceFrame.LOCAL
        found = pinocchio.StdVec_RigidConstraintModel()
        for frame in frames[1:]:
            ends = (one for end in (frames[0], frame) for one in (end.parentJoint, end.placement))
            found.append(pinocchio.RigidConstraintModel(kind, self.model, *ends, local))
        return found
