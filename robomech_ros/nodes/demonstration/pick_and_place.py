"""The task of the demonstration: to a pick pose, then to a place pose."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import PlanCartesian, PlanJoint, SolveFK, SolveIK
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.message_fields import seconds_from_duration
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.demonstration.client import DemoClient
from robomech_ros.nodes.demonstration.postures import pick_and_place
from robomech_ros.nodes.demonstration.report import Leg, Reporter, TipPath, listed_numbers
from robomech_ros.nodes.demonstration.suite import DemoFailedError
from robomech_ros.robots import PRISMATIC, SerialChain
from robomech_ros.robots.semantic import HOME
from robomech_ros.rvs import Choice, NamedPosture
from robomech_ros.spatial import pose_error
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.nodes.demonstration.demo_platform import DemoPlatform

_SERVICE = "joint_trajectory_controller/set_parameters_atomically"
# Further services of the demonstration if the robot carries a load.
CARRYING: dict[str, Any] = {_SERVICE: SetParametersAtomically}

# How far a joint may be off its path, rad or m: the controller ends a motion that is farther.
TRACKED = 0.02
# Joints this close to the goal, and as slow, are there: rad or m, and per s; and the robot has
# arrived when its tip is so close to the target, m and rad.  Friction holds back what drives move.
_EXACT = (1e-6, 1e-4)
_DRIVEN = (5e-3, 1e-2)
_GRACE_SECONDS = 10.0
# Number of kept samples of a self-motion.
MOST_OTHERS = 16
_PROFILES = {"RUCKIG": PlanJoint.Request.RUCKIG, "POLY345": PlanJoint.Request.POLY345}


def carry(client: DemoClient, mass: float) -> None:
    """Replace the robot's load by a mass (kg) that is unknown to its drive controller."""
    change_parameters(client, {"payload_mass": mass})


def change_parameters(client: DemoClient, values: Mapping[str, float | Sequence[float]]) -> None:
    """Change parameters of the controller, all at once."""
    parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
    result = client.ask(_SERVICE, SetParametersAtomically.Request(parameters=parameters)).result
    if not result.successful:
        raise DemoFailedError(f"{', '.join(values)}: {result.reason}")


class DemoArm:
    """An arm; `DemoPlatform` has the same methods.

    - ``title``: one-line description of the robot.
    - ``shown``: numbers of the joints that are printed and plotted.
    """

    def __init__(self, chain: SerialChain) -> None:
        self.model = chain
        self.name, self.base = chain.name, chain.base
        self.joint_names, self.units = chain.joint_names, chain.units
        self.shown = range(chain.n)
        joints = "".join("P" if kind == PRISMATIC else "R" for kind in chain.types)
        self.title = f"{chain.name}: {chain.n} joints {joints}, {chain.base} to {chain.tip}"

    def pose(self, q: Array) -> Array:
        """Pose of the tip in the base (4, 4), of joints (n,)."""
        return forward_kinematics(self.model, q)

    def targets(self) -> tuple[Array, Array]:
        """Poses (4, 4) where to pick and where to place."""
        pick, place = pick_and_place(self.model)
        return self.pose(pick), self.pose(place)

    def path_to_place(self, pick: Array, place: Array) -> TipPath | None:
        """Return None: the way of the tip is left to the joints."""

    def path_onward(self, place: Array) -> TipPath | None:
        """Return None: an arm ends at place."""


DemoRobot: TypeAlias = "DemoArm | DemoPlatform"


class PickAndPlace:
    """Solves, plans, executes and checks both motions through the services of the suite.

    - ``reporter``: where to tell what happens.
    - ``payload``: the mass (kg) that a robot moved by drives carries from pick to place; None = it
      goes exactly where it is told.
    """

    def __init__(
        self, client: DemoClient, robot: DemoRobot, reporter: Reporter, payload: float | None = None
    ) -> None:
        self._client, self._robot, self._reporter, self._payload = client, robot, reporter, payload
        self._joints_arrived, self._arrived = _DRIVEN if payload is not None else _EXACT
        self.legs: list[Leg] = []
        self.choices: list[Choice] = []
        self.marks: list[tuple[float, str]] = []

    def run(self) -> None:
        """Do all of it."""
        pick, place = self._robot.targets()
        over, on = self._robot.path_to_place(pick, place), self._robot.path_onward(place)
        self._leg("pick", "RUCKIG", pick)
        if self._payload is not None:
            carry(self._client, self._payload)
            self._reporter.say(
                f"picked {self._payload:g} kg, unknown to the controller of the drives"
            )
        if over is None:
            self._leg("place", "POLY345", place)
        else:
            self._along(over)
        if self._payload is not None:
            carry(self._client, 0.0)
            self._reporter.say(
                f"every joint stayed within {TRACKED:g} rad or m of its path: the controller would "
                "have ended the motion (path_tolerance)"
            )
        if on is not None:
            self._along(on)

    def stands_at_home(self) -> None:
        """Check that the robot begins where the named posture home is."""
        home = self._robot.model.home()
        self._client.wait_until_at(home, self._joints_arrived, _GRACE_SECONDS)
        self._reporter.say(f"stands at {HOME}: {listed_numbers(home)} rad or m")

    def go_home(self) -> None:
        """Move to the named posture home, which the planner is told by its name alone."""
        home = self._robot.model.home()
        self._reporter.heading(f"{HOME}, by its name")
        self.marks.append((self._client.now(), f"{HOME} (RUCKIG)"))
        self._move(HOME, "RUCKIG", JointState(name=[HOME]), home, self._robot.pose(home))

    def _leg(self, name: str, profile: str, T: Array) -> None:
        self._reporter.heading(f"{name} at x y z = {listed_numbers(T[:3, 3])} m")
        goal = self._solve(name, T)
        self.marks.append((self._client.now(), f"{name} ({profile})"))
        self._move(name, profile, goal, goal, T)

    def _along(self, path: TipPath) -> None:
        """Move the tip along a path, to where it ends."""
        T = path.waypoints[-1]
        count = len(path.waypoints)
        self._reporter.heading(f"{path.name} through {count} poses to {listed_numbers(T[:3, 3])} m")
        goal = self._solve(path.name, T)
        self.marks.append((self._client.now(), f"{path.name} (TIME_OPTIMAL)"))
        request = PlanCartesian.Request(
            start=self._client.state,
            waypoints=[stamped_pose(pose, self._robot.base) for pose in path.waypoints],
            path=getattr(PlanCartesian.Request, path.path_kind),
            profile=PlanCartesian.Request.TIME_OPTIMAL,
        )
        response = self._client.call("trajectory_planner/plan_cartesian", request)
        points = response.trajectory.points
        duration = seconds_from_duration(points[-1].time_from_start, "time_from_start")
        leg = Leg(path.name, path.path_kind, duration, float("nan"))
        self._reporter.say(
            f"planned {path.path_kind}: {duration:.2f} s, {len(points)} points, all "
            "within the limits of every joint"
        )
        self._execute(leg, response.trajectory, goal, T)

    def _solve(self, name: str, T: Array) -> Array:
        """Ask for all solutions, and choose the nearest one inside the limits."""
        request = SolveIK.Request(target=stamped_pose(T, self._robot.base), seed=self._client.state)
        response = self._client.call("kinematics/solve_ik", request)
        goal = np.array(response.solutions[0].positions)
        # The first is taken.
        first, *others = (
            NamedPosture(branch, np.array(point.positions))
            for branch, point in zip(response.branches, response.solutions, strict=True)
        )
        kept = tuple(others[: MOST_OTHERS - 1])
        self.choices.append(Choice(self._client.now(), name, first.name, kept))
        shown, chosen = response, 0
        if response.complete:
            # In closed form there is no harm in showing what the limits exclude, too.
            request.ignore_limits = True
            shown = self._client.call("kinematics/solve_ik", request)
            distances = [np.abs(np.array(p.positions) - goal).max() for p in shown.solutions]
            chosen = int(np.argmin(distances))
        seconds = seconds_from_duration(response.solve_time, "solve_time")
        k = len(response.solutions)
        count = f"{k} of {len(shown.solutions)}" if response.complete else f"{k}"
        how = "provably all there are" if response.complete else "found by searching"
        self._reporter.say(
            f"solutions inside the limits: {count}, {how} ({response.family}, "
            f"{seconds * 1e6:.0f} us); rad or m:"
        )
        self._reporter.solutions(shown, chosen, self._robot.shown)
        return goal

    def _move(
        self, name: str, profile: str, named: Array | JointState, goal: Array, T: Array
    ) -> None:
        """Plan a motion to a goal, shape (n,), by values or by name, and execute it to a pose."""
        # Arrival is judged by the goal itself.
        response = self._client.plan_joint(named, profile=_PROFILES[profile], keep_turns=True)
        duration = seconds_from_duration(response.duration, "duration")
        leg = Leg(name, profile, duration, max(response.peak_velocity_ratio))
        self._reporter.say(
            f"planned {profile}: {duration:.2f} s, {len(response.trajectory.points)} points, "
            f"peak velocity {leg.peak:.0%} of its limit, peak acceleration "
            f"{max(response.peak_acceleration_ratio):.0%}"
        )
        self._execute(leg, response.trajectory, goal, T)

    def _execute(self, leg: Leg, trajectory: JointTrajectory, goal: Array, T: Array) -> None:
        """Execute a motion to a pose, and show which part of its duration it has lasted."""
        shown = list(self._robot.shown)
        with self._reporter.progress(leg.name) as show:
            self._client.follow(
                trajectory, goal, self._joints_arrived, lambda done, q: show(done, q[shown])
            )
        self._check(leg, T)
        self.legs.append(leg)

    def _check(self, leg: Leg, T: Array) -> None:
        """Compare where the tip is, by forward kinematics of the joints, with the target."""
        request = SolveFK.Request(states=[self._client.state])
        response = self._client.call("kinematics/solve_fk", request)
        error = pose_error(T, matrix_from_pose(response.poses[0].pose))
        norms = np.linalg.norm(error.reshape(2, 3), axis=1)
        leg.orientation_error, leg.position_error = norms.tolist()
        text = (
            f"{leg.name}: the tip is off by {leg.position_error * 1e3:.2e} mm and "
            f"{leg.orientation_error:.2e} rad"
        )
        if max(leg.position_error, leg.orientation_error) > self._arrived:
            raise DemoFailedError(f"{text}; the robot did not arrive")
        self._reporter.say(text)
