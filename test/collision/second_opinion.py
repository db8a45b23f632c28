"""The same robots and objects in Pinocchio: forward kinematics, distances and contacts."""

import coal
import numpy as np
import pinocchio as pin

from robomech_ros.collision import Box, Capsule, Cone, Cylinder, Mesh, Plane, Sphere


def geometries(shape):
    """Return the geometries of a shape: more than one for a link's mesh that is not convex."""
    if isinstance(shape, Mesh):
        return [body.geometry for body in shape.parts()]
    if isinstance(shape, Box):
        return [coal.Box(shape.x, shape.y, shape.z)]
    if isinstance(shape, Sphere):
        return [coal.Sphere(shape.radius)]
    if isinstance(shape, Plane):
        return [coal.Halfspace(shape.normal, shape.offset)]
    kind = {Cylinder: coal.Cylinder, Capsule: coal.Capsule, Cone: coal.Cone}[type(shape)]
    return [kind(shape.radius, shape.height)]


class SecondOpinion:
    """A scene as Pinocchio has it.

    Parameters
    ----------
    scene : PlanningScene
        Of which the chain, the objects and the pairs that are ignored are used.
    shapes : sequence of (str, Shape, pose)
        Of the links.
    others : dict
        Joints that are not of the chain.
    """

    def __init__(self, scene, shapes, others=None):
        text = scene.chain.description.document
        self.model = pin.buildModelFromXML(text)
        self.scene = scene
        self._others = others or {}
        self._start = pin.neutral(self.model)
        self._set(self._start, np.zeros(scene.chain.n))
        data = self.model.createData()
        pin.framesForwardKinematics(self.model, data, self._start)
        self.base = data.oMf[self.model.getFrameId(scene.chain.base)]
        self.geometry = pin.GeometryModel()
        self.owners = []
        for link, shape, pose in shapes:
            for one in geometries(shape):
                self._add(link, self._frame(link), pin.SE3(np.asarray(pose)), one)
        for name, one in scene.objects.items():
            for shape, _, pose in one.parts:
                placed = pin.SE3(one.pose @ pose)
                if one.link:
                    self._add(name, self._frame(one.link), placed, *geometries(shape))
                else:
                    self._add(name, None, self.base * placed, *geometries(shape))
        ignored = {frozenset(pair) for pair in scene.ignored}
        for i, first in enumerate(self.owners):
            for k in range(i):
                if first != self.owners[k] and frozenset((first, self.owners[k])) not in ignored:
                    self.geometry.addCollisionPair(pin.CollisionPair(k, i))
        self.data = self.model.createData()
        self.found = pin.GeometryData(self.geometry)
        for request in self.found.distanceRequests:
            request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess
            request.gjk_tolerance = 1e-10

    def _frame(self, link):
        return self.model.frames[self.model.getFrameId(link)]

    def _add(self, owner, frame, pose, *geometries):
        joint, placement = (
            (frame.parentJoint, frame.placement) if frame else (0, pin.SE3.Identity())
        )
        for one in geometries:
            name = f"{owner} {len(self.owners)}"
            added = pin.GeometryObject(name, joint, placement * pose, one)
            self.geometry.addGeometryObject(added)
            self.owners.append(owner)

    def _set(self, full, q):
        chain = self.scene.chain
        values = {**dict(zip(chain.joint_names, q, strict=True)), **self._others}
        followers = chain.description.followers
        for name, follower in followers.items():
            if name not in self._others:
                leader = values.get(follower.leader, 0.0)
                values[name] = follower.multiplier * leader + follower.offset
        for name, value in values.items():
            if not self.model.existJointName(name):
                continue
            joint = self.model.joints[self.model.getJointId(name)]
            if joint.nq == 2:
                full[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
            else:
                full[joint.idx_q] = value
        return full

    def posture(self, q):
        """Return the joint values of Pinocchio."""
        return self._set(self._start.copy(), q)

    def clearance(self, q):
        """Return the least distance (m), and its two bodies."""
        at = pin.computeDistances(self.model, self.data, self.geometry, self.found, self.posture(q))
        pair = self.geometry.collisionPairs[at]
        owners = frozenset((self.owners[pair.first], self.owners[pair.second]))
        return self.found.distanceResults[at].min_distance, owners

    def distance_of(self, bodies, q):
        """Return the distance of two bodies (m)."""
        pin.updateGeometryPlacements(
            self.model, self.data, self.geometry, self.found, self.posture(q)
        )
        return min(
            pin.computeDistance(self.geometry, self.found, k).min_distance
            for k, pair in enumerate(self.geometry.collisionPairs)
            if {self.owners[pair.first], self.owners[pair.second]} == set(bodies)
        )

    def hits(self, q):
        """Whether anything is in contact."""
        return pin.computeCollisions(
            self.model, self.data, self.geometry, self.found, self.posture(q), True
        )

    def first_hit(self, postures):
        """Return the number of the first posture in contact, or None."""
        return next((k for k, q in enumerate(postures) if self.hits(q)), None)
