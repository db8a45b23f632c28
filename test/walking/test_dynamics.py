"""Dynamics of walking machines, against Pinocchio's free flyer with legs and its constraints."""

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import (
    BadValueError,
    MissingInertiaError,
    MissingSupportError,
    NonFiniteError,
)
from robomech_ros.robots import load_description
from robomech_ros.spatial import pose_exponential, quaternion_from_matrix
from robomech_ros.walking import LeggedRobot, Walker, WalkingDynamics, gait_torques, load_legged

POSE = pose_exponential([0.2, -0.1, 0.5, 1.0, 2.0, 0.3])
GRAVITY = np.array([0.0, 0.0, -9.81])
STANCES = {"phantomx": ["LF", "LR", "RM"], "go1": ["FL", "RL", "RR"]}


class Peer:
    """A robot as Pinocchio's tree with a free flyer, in the same order of joints."""

    def __init__(self, robot):
        self.model = model = pinocchio.Model()
        self.robot, self.feet = robot, []
        root = model.addJoint(0, pinocchio.JointModelFreeFlyer(), pinocchio.SE3.Identity(), "root")
        self._append(root, robot.trunk_body)
        for name, leg in zip(robot.leg_names, robot.legs, strict=True):
            parent, rows = root, [pinocchio.SE3(T) for T in leg.transforms]
            for joint, row, body in zip(leg.joint_names, rows, leg.bodies, strict=False):
                parent = model.addJoint(parent, pinocchio.JointModelRZ(), row, joint)
                self._append(parent, body)
            kind = pinocchio.FrameType.OP_FRAME
            self.feet.append(model.addFrame(pinocchio.Frame(name, parent, 0, rows[-1], kind)))
        self.data = model.createData()
        self.order = [3, 4, 5, 0, 1, 2, *range(6, 6 + robot.n)]

    def _append(self, joint, body):
        inertia = pinocchio.Inertia(body.mass, np.array(body.com), np.array(body.inertia))
        self.model.appendBodyToJoint(joint, inertia, pinocchio.SE3.Identity())

    def at(self, q):
        return np.concatenate((POSE[:3, 3], quaternion_from_matrix(POSE[:3, :3]), q))

    def foot_motion(self, q, u, du):
        """Velocities and accelerations of all feet over the ground, (k, 3) each."""
        pinocchio.forwardKinematics(
            self.model, self.data, self.at(q), u[self.order], du[self.order]
        )
        world = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        velocities, accelerations = [], []
        for foot in self.feet:
            given = self.model, self.data, foot, world
            velocities.append(pinocchio.getFrameVelocity(*given).linear)
            accelerations.append(pinocchio.getFrameClassicalAcceleration(*given).linear)
        return np.array(velocities), np.array(accelerations)

    def jacobians(self, q):
        """Jacobians of all feet, in the world, by our order of rates, (k, 3, 6 + n)."""
        pinocchio.computeJointJacobians(self.model, self.data, self.at(q))
        pinocchio.updateFramePlacements(self.model, self.data)
        world = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        rows = [pinocchio.getFrameJacobian(self.model, self.data, f, world) for f in self.feet]
        return np.array(rows)[:, :3, self.order]


@pytest.fixture(scope="module", params=STANCES)
def peer(request):
    return Peer(load_legged(request.param))


def state(robot, seed=1):
    rng = np.random.default_rng(seed)
    q = np.clip(robot.home + rng.uniform(-0.2, 0.2, robot.n), robot.lower, robot.upper)
    return q, *rng.uniform(-1.0, 1.0, (2, 6 + robot.n))


def test_a_machine_in_the_air_is_pinocchios_tree(peer):
    dynamics, order = WalkingDynamics(peer.robot), peer.order
    q, u, du = state(peer.robot)
    M = np.triu(pinocchio.crba(peer.model, peer.data, peer.at(q)))
    M = (M + np.triu(M, 1).T)[np.ix_(order, order)]
    np.testing.assert_allclose(dynamics.mass_matrix(q), M, atol=1e-12)
    efforts = pinocchio.rnea(peer.model, peer.data, peer.at(q), u[order], du[order])[order]
    found = dynamics.inverse(q, u, du, gravity=POSE[:3, :3].T @ GRAVITY)
    np.testing.assert_allclose(found, efforts, atol=1e-10)


def test_planted_feet_stand_still_and_torques_move_the_rest(peer):
    """The orthogonal complement against Lagrange multipliers with Pinocchio's matrices."""
    robot, stance = peer.robot, STANCES[peer.robot.name]
    dynamics, order = WalkingDynamics(robot), peer.order
    q, u, _ = state(robot, 2)
    standing = robot.standing(stance)
    independent = u[: 6 + robot.n - 3 * len(standing)]
    rates, drift = dynamics.stance_motion(q, independent, 0.0 * independent, stance)
    velocities, accelerations = peer.foot_motion(q, rates, drift)
    assert np.abs(velocities[list(standing)]).max() < 1e-12
    assert np.abs(accelerations[list(standing)]).max() < 1e-11
    tau = np.random.default_rng(3).uniform(-1.0, 1.0, robot.n)
    gravity = POSE[:3, :3].T @ GRAVITY
    motion = dynamics.planted_forward(q, independent, tau, stance=stance, gravity=gravity)
    M = np.triu(pinocchio.crba(peer.model, peer.data, peer.at(q)))
    M = (M + np.triu(M, 1).T)[np.ix_(order, order)]
    at, v = peer.at(q), rates[order]
    bias = pinocchio.nonLinearEffects(peer.model, peer.data, at, v)[order]
    J = peer.jacobians(q)[list(standing)].reshape(-1, 6 + robot.n)
    _, still = peer.foot_motion(q, rates, np.zeros_like(rates))
    zero = np.zeros((len(J), len(J)))
    left = np.concatenate((np.zeros(6), tau)) - bias
    right = np.concatenate((left, -still[list(standing)].ravel()))
    found = np.linalg.solve(np.block([[M, -J.T], [J, zero]]), right)
    n = 6 + robot.n
    scale = np.abs(found[:n]).max()
    np.testing.assert_allclose(motion.accelerations, found[:n], atol=1e-10 * scale)
    forces = found[n:].reshape(-1, 3) @ POSE[:3, :3]
    np.testing.assert_allclose(motion.forces[list(standing)], forces, atol=1e-9)


def test_a_leg_that_is_only_nearly_stretched_still_stands():
    robot = load_legged("go1")
    q = robot.home.copy()
    q[2] = -3e-8
    (x, y, z), J = robot.feet(q)[0], robot.foot_jacobians(q)[0]
    still = J @ WalkingDynamics(robot).complement(q)[6:9]
    expected = [[0.0, -z, y, -1, 0, 0], [z, 0.0, -x, 0, -1, 0], [-y, x, 0.0, 0, 0, -1]]
    np.testing.assert_allclose(still, expected, atol=1e-7)


def test_shared_loads_give_back_the_motion(peer):
    """Forces and torques of a motion, put on Pinocchio's tree, accelerate it as asked."""
    robot, stance = peer.robot, STANCES[peer.robot.name]
    dynamics, order = WalkingDynamics(robot), peer.order
    q = robot.home
    legs = 6 + robot.n - 3 * len(stance)
    independent, changes = 0.02 * np.cos(np.arange(2 * legs)).reshape(2, -1)
    # The acceleration shifts the zero-moment point to the middle of the feet that stand.
    changes[3:5] = -20.0 * robot.feet(q)[list(robot.standing(stance))].mean(axis=0)[:2]
    u, du = dynamics.stance_motion(q, independent, changes, stance)
    gravity = POSE[:3, :3].T @ GRAVITY
    options = {"stance": stance, "gravity": gravity, "normals": POSE[2, :3], "friction": 0.9}
    for smallest in ("forces", "torques"):
        share = dynamics.share_load(q, u, du, **options, smallest=smallest)
        pushed = np.concatenate((np.zeros(6), share.torques))
        forces = share.forces @ POSE[:3, :3].T
        pushed += np.einsum("kij,ki->j", peer.jacobians(q), forces)
        found = pinocchio.aba(peer.model, peer.data, peer.at(q), u[order], pushed[order])[order]
        np.testing.assert_allclose(found, du, atol=1e-5)
        assert share.used_friction.max() <= 1.0 and share.used_effort.max() <= 1.0


def test_a_walk_takes_no_work_but_for_the_turns_of_its_legs():
    """Over a steady cycle no energy is gained, and the ground carries the weight."""
    robot = load_legged("phantomx")
    dynamics = WalkingDynamics(robot)
    walk = gait_torques(dynamics, Walker(robot, period=0.01), [0.1, 0.04, 0.0])
    assert (walk.contacts.sum(axis=1) >= 3).all()
    assert (walk.forces[~walk.contacts] == 0.0).all()
    assert (walk.forces[..., 2] >= -1e-9).all()
    power = np.einsum("ij,ij->i", walk.torques, walk.rates[:, 6:])
    assert abs(power.mean()) < 0.01 * np.abs(power).max()
    weight = -9.81 * (1.2 + 6 * 0.17)
    assert walk.forces[..., 2].sum(axis=1).mean() == pytest.approx(-weight, rel=1e-3)
    at = np.abs(walk.torques).argmax(axis=0)
    np.testing.assert_array_equal(walk.peaks, np.abs(walk.torques[at, np.arange(18)]))
    np.testing.assert_array_equal(walk.peak_times, walk.t[at])
    np.testing.assert_allclose(walk.used_effort, walk.peaks / 1.5)
    with pytest.raises(MissingSupportError, match=r"feet F., R. cannot carry the load at 0"):
        go1 = load_legged("go1")
        gait_torques(WalkingDynamics(go1), Walker(go1, gait="trot"), [0.0, 0.05, 0.0])


def test_bodies_come_from_the_document_or_the_tree():
    go1 = load_legged("go1")
    bodies = [go1.trunk_body, *(body for leg in go1.legs for body in leg.bodies)]
    # 4.8 kg, and 0.510299, 0.898919, 0.158015 and 0.06 kg a leg.
    assert sum(body.mass for body in bodies) == pytest.approx(4.8 + 4 * 1.627233, abs=1e-9)
    np.testing.assert_array_equal(go1.effort, 33.5)
    feet = {name: leg.tip for name, leg in zip(go1.leg_names, go1.legs, strict=True)}
    again = LeggedRobot.from_description(go1.description, feet)
    M = WalkingDynamics(go1).mass_matrix(go1.home)
    np.testing.assert_allclose(WalkingDynamics(again).mass_matrix(go1.home), M, atol=1e-12)
    dog = load_description("test/data/quadruped_with_head.urdf")
    robot = LeggedRobot.from_description(
        dog, {leg: f"{leg}_foot" for leg in ("FL", "FR", "RL", "RR")}
    )
    legs = sum(body.mass for leg in robot.legs for body in leg.bodies if body)
    total = sum(body.mass for body in dog.bodies.values())
    assert robot.trunk_body.mass + legs == pytest.approx(total, abs=1e-12)


def test_wrong_requests_name_what_is_wrong():
    robot = load_legged("go1")
    bare = LeggedRobot(dict(zip(robot.leg_names, robot.legs, strict=True)))
    with pytest.raises(MissingInertiaError, match="trunk"):
        WalkingDynamics(bare)
    dynamics = WalkingDynamics(robot)
    with pytest.raises(BadValueError, match="rates"):
        dynamics.inverse(robot.home, "fast", np.zeros(18))
    with pytest.raises(BadValueError, match="posture of leg 'FL'"):
        dynamics.complement(np.zeros(12))
    with pytest.raises(BadValueError, match="robot of the walker"):
        gait_torques(dynamics, Walker(load_legged("phantomx")), [0.0, 0.0, 0.0])


@pytest.mark.parametrize("size", [1e308, np.nan])
def test_numbers_that_overflow_are_named(size):
    dynamics = WalkingDynamics(load_legged("go1"))
    q, still, none = dynamics.robot.home, np.zeros(6), np.zeros(12)
    for call, text in (
        (lambda: dynamics.planted_forward(q, np.full(6, size), none), "independent"),
        (lambda: dynamics.planted_forward(q, still, np.full(12, size)), "torques"),
        (lambda: dynamics.planted_forward(q, still, none, gravity=np.full(3, size)), "gravity"),
        (lambda: dynamics.stance_motion(q, still, np.full(6, size)), "changes"),
        (lambda: dynamics.robot.stance_rates(q, np.full(6, size)), "twist"),
        (lambda: dynamics.inverse(q, np.zeros(18), np.zeros(18), gravity=[size] * 3), "gravity"),
    ):
        with pytest.raises((BadValueError, NonFiniteError), match=text):
            call()
