"""The task of the capture: an approach in inertial space, a contact, and the way back."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from nav_msgs.msg import Odometry
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import PlanCartesian, SolveIK
from robomech_ros.dynamics import FloatingChain, with_payload
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.nodes.common.messages.pose_messages import (
    matrix_from_pose,
    stamped_pose,
    twist_vector,
)
from robomech_ros.nodes.demonstration.client import DemoClient, seconds_of
from robomech_ros.nodes.demonstration.pick_and_place import change_parameters
from robomech_ros.nodes.demonstration.report import Reporter
from robomech_ros.nodes.demonstration.suite import DemoFailedError
from robomech_ros.robots import Body
from robomech_ros.spatial import pose_error, rotation_vector_from_matrix
from robomech_ros.typing import Array, BoolArray

_INERTIAL = "odom"
# The approach in the axes of the tip, in parts of the size of the arm.
_APPROACH = (0.04, 0.0, 0.08)
# Part of the base's mass, side in the size of the arm, and speed (m/s) of the body.
_MASS, _SIDE, _SPEED = 0.05, 0.08, 0.05
# From the arrival to the contact, and after it (s).
_WAIT, _DRIFT = 2.0, 3.0
# Rest of joints (rad or m), and what the tip may miss in inertial space (m and rad).
_ARRIVED, _TIP = 1e-9, 1e-6
# Part by which the momentum may change.
_KEPT = 1e-10
_PATIENCE = 30.0


class States(NamedTuple):
    """States of the robot.

    - ``q``, ``qd``: joint values and rates, shape (m, n).
    """

    #: Times of the recording (s), shape (m,).
    t: Array
    #: Poses of the base in the inertial frame (m), shape (m, 4, 4).
    poses: Array
    #: Twists of the base in its own axes, angular first (rad/s, m/s), shape (m, 6).
    twists: Array
    q: Array
    qd: Array


class CaptureTask:
    """Captures a drifting body.

    - ``robot``: chain of n joints.
    - ``captured``: the drifting body in its own frame, whose axes are those of the tip at the
      contact.
    - ``marks``: times of the recording (s), and the names of the motions that begin there.
    """

    def __init__(self, client: DemoClient, robot: FloatingChain, reporter: Reporter) -> None:
        self._client, self._robot, self._reporter = client, robot, reporter
        size = arm_size(robot.chain)
        self._size, mass, self._side = size, min(_MASS * robot.mass, 1000.0), _SIDE * size
        inertia = mass * self._side**2 / 6.0 * np.eye(3)
        self.captured = Body(mass, np.zeros(3), inertia)
        self.marks: list[tuple[float, str]] = []
        self._rows: list[tuple[float, Array, Array]] = []
        client.node.create_subscription(Odometry, "odom", self._odometry, 1000)

    def run(self) -> None:
        """Approach, capture, and bring the arm back."""
        home = self._client.present
        tip = forward_kinematics(self._robot.chain, home)
        self._goal = tip.copy()
        self._goal[:3, 3] += self._size * tip[:3, :3] @ np.array(_APPROACH)
        self._approach()
        self._velocity = -_SPEED * self._goal[:3, 2]
        self._capture()
        self._mark("way back")
        self._execute("way back", self._client.plan_joint(home).trajectory)

    def states(self) -> States:
        """Return the states whose pose and joints are known at the same time."""
        t, q, qd = self._client.recording()
        rows = {round((row[0] - self._client.began) * 1e6): row for row in list(self._rows)}
        known = [(k, rows.get(round(time * 1e6))) for k, time in enumerate(t.tolist())]
        kept = [(k, row) for k, row in known if row is not None]
        at = [k for k, _ in kept]
        poses, twists = (np.array([row[i] for _, row in kept]) for i in (1, 2))
        return States(t[at], poses, twists, q[at], qd[at])

    def body_poses(self, states: States) -> Array:
        """Return the poses (m, 4, 4) of the body (m): it drifts, then the tip holds it."""
        tips = states.poses @ forward_kinematics(self._robot.chain, states.q)
        held = tips.copy()
        held[:, :3, 3] += 0.5 * self._side * tips[:, :3, 2]
        free = np.tile(self._goal, (len(tips), 1, 1))
        met = self._goal[:3, 3] + 0.5 * self._side * self._goal[:3, 2]
        free[:, :3, 3] = met + np.outer(states.t - self._contact, self._velocity)
        return np.where((states.t < self._contact)[:, None, None], free, held)

    def momenta(self, states: States) -> Array:
        """Return linear momenta along the velocity of the body (N s), shape (m, 4).

        The columns are the base, the arm with its payload, the free body, and the sum; NaN around
        the contact.
        """
        along, found = self._velocity / _SPEED, np.full((len(states.t), 4), np.nan)
        before, after = self._around_contact(states)
        for robot, rows in ((self._robot, before), (self._loaded, after)):
            found[rows, 3] = self._momenta(robot, states, rows)[0][:, 3:] @ along
        found[before, 2], found[after, 2] = self.captured.mass * _SPEED, 0.0
        base = self._robot.base
        assert base is not None
        speeds = states.twists[:, 3:] + np.cross(states.twists[:, :3], base.com)
        found[:, 0] = base.mass * np.einsum("mij,mj,i->m", states.poses[:, :3, :3], speeds, along)
        found[:, 1] = found[:, 3] - found[:, 0]
        found[:, 3] += found[:, 2]
        return found

    @cached_property
    def _loaded(self) -> FloatingChain:
        """The robot that holds the body."""
        body = Body(self.captured.mass, np.array([0.0, 0.0, 0.5 * self._side]), np.zeros((3, 3)))
        return FloatingChain(with_payload(self._robot.chain, body), self._robot.base)

    def _around_contact(self, states: States) -> tuple[BoolArray, BoolArray]:
        """Return which states are before the contact, and which after it."""
        return states.t < self._before, states.t > self._after

    def prove(self) -> None:
        """Check the momentum before and after, and say where the base is."""
        states, say = self.states(), self._reporter
        loaded, before, after = self._loaded, *self._around_contact(states)
        found, alone = self._momenta(self._robot, states, before)
        scale = np.linalg.norm(alone, axis=1).max()
        off = float(np.linalg.norm(found, axis=1).max() / scale)
        text = f"momentum before the contact: zero up to {off:.1e} of that of the links alone"
        say.check(off < _KEPT, text)
        found, _ = self._momenta(loaded, states, after)
        mean = found.mean(axis=0)
        off = float(np.linalg.norm(found - mean, axis=1).max() / np.linalg.norm(mean))
        say.check(off < _KEPT, f"momentum after it: constant up to {off:.1e} of its size")
        last = np.flatnonzero(before)[-1]
        expected = self._expected(loaded, states, int(last))
        off = float(np.linalg.norm(mean - expected) / np.linalg.norm(expected))
        say.check(off < _KEPT, f"it is the momentum of the body before, up to {off:.1e}")
        T = states.poses[-1]
        angle = float(np.linalg.norm(rotation_vector_from_matrix(T[:3, :3])))
        x, y, z = T[:3, 3].tolist()
        say.say(
            f"the base has moved by x {x:+.3f} m, y {y:+.3f} m, z {z:+.3f} m and turned by "
            f"{angle:.4f} rad; the mass centre drifts at "
            f"{np.linalg.norm(mean[3:]) / loaded.mass * 1e3:.3f} mm/s"
        )

    def _approach(self) -> None:
        say, goal = self._reporter, self._goal
        self._mark("approach")
        target = stamped_pose(goal, _INERTIAL)
        solved = self._client.call("kinematics/solve_ik", SolveIK.Request(target=target))
        say.say(f"approach: {solved.error_msg}")
        request = PlanCartesian.Request(
            start=self._client.state, waypoints=[target], profile=PlanCartesian.Request.TIME_OPTIMAL
        )
        planned = self._client.call("trajectory_planner/plan_cartesian", request)
        self._execute("approach", planned.trajectory)
        states = self.states()
        at = forward_kinematics(self._robot.chain, states.q[-1])
        position, angle = _distances(goal, states.poses[-1] @ at)
        text = f"tip in inertial space: {position * 1e3:.1e} mm and {angle:.1e} rad off"
        say.check(position < _TIP and angle < _TIP, text)
        missed, _ = _distances(goal, at)
        say.say(f"on a fixed base these joints would miss by {missed * 1e3:.0f} mm")

    def _capture(self) -> None:
        """Wait for the body, and fix it to the tip."""
        self._mark("contact")
        self._contact = self._client.now() + _WAIT
        self._wait_until(self._contact)
        self._before = self._contact
        change_parameters(
            self._client,
            {
                "payload_mass": self.captured.mass,
                "payload_com": [0.0, 0.0, 0.5 * self._side],
                "payload_velocity": self._velocity.tolist(),
            },
        )
        self._after = self._client.now() + 0.1
        late = (self._after - 0.1 - self._contact) * _SPEED
        self._reporter.say(
            f"contact with {self.captured.mass:g} kg at {_SPEED * 1e3:g} mm/s, taken within "
            f"{late * 1e3:.1f} mm; the arm stops it"
        )
        self._wait_until(self._after + _DRIFT)

    def _expected(self, loaded: FloatingChain, states: States, k: int) -> Array:
        """Return the momentum (6,) of the body alone, about the common mass centre, at a state."""
        T = states.poses[k]
        tip = T @ forward_kinematics(self._robot.chain, states.q[k])
        own = tip[:3, 3] + 0.5 * self._side * tip[:3, 2]
        centre = T[:3, :3] @ loaded.center_of_mass(states.q[k]) + T[:3, 3]
        linear = self.captured.mass * self._velocity
        return np.concatenate((np.cross(own - centre, linear), linear))

    def _momenta(
        self, robot: FloatingChain, states: States, rows: BoolArray
    ) -> tuple[Array, Array]:
        """Return momenta (m, 6) in the inertial axes, and those of links on a base at rest."""
        found: list[list[Array]] = [[], []]
        chosen = zip(*(part[rows] for part in states[1:]), strict=True)
        for T, twist, q, qd in chosen:
            for momenta, base in zip(found, (twist, np.zeros(6)), strict=True):
                inside = robot.momentum(q, np.concatenate((base, qd)))
                momenta.append((inside.reshape(2, 3) @ T[:3, :3].T).ravel())
        return np.array(found[0]), np.array(found[1])

    def _execute(self, name: str, trajectory: JointTrajectory) -> None:
        with self._reporter.progress(name) as show:
            goal = np.array(trajectory.points[-1].positions)
            self._client.follow(trajectory, goal, _ARRIVED, show)
        # The odometry of the last joint state comes after it.
        self._wait_until(self._client.now() + 0.1)

    def _wait_until(self, time: float) -> None:
        def reached() -> bool:
            return bool(self._rows) and self._rows[-1][0] - self._client.began >= time

        if not self._client.wait(reached, _PATIENCE):
            raise DemoFailedError(f"after {_PATIENCE:g} s no odometry of the base comes")

    def _mark(self, name: str) -> None:
        self.marks.append((self._client.now(), name))

    def _odometry(self, message: Odometry) -> None:
        pose, twist = matrix_from_pose(message.pose.pose), twist_vector(message.twist.twist)
        self._rows.append((seconds_of(message), pose, twist))


def _distances(wanted: Array, T: Array) -> tuple[float, float]:
    """Return the distance (m) and the angle (rad) between two poses."""
    error = pose_error(wanted, T)
    return float(np.linalg.norm(error[3:])), float(np.linalg.norm(error[:3]))
