"""The simulated robot as the topic, the action and the services command it."""

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.follower import Follower
from robomech_ros.execution.controller.saturation import saturation_text
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.controller.trajectory_goal import GoalResult, TrajectoryGoal
from robomech_ros.execution.joints import Joints
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.execution.refusals import TrajectoryRefusedError
from robomech_ros.nodes.common.error_codes import code_of
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.received_trajectory import received_trajectory
from robomech_ros.nodes.common.refusals import trajectory_label
from robomech_ros.nodes.joint_trajectory_controller.motion_counts import MotionCounts
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    DYNAMIC,
    ControllerSettings,
    check_simulation,
    default_tolerances,
    follower_settings,
    initial_position,
)
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory.waypoints import Waypoints

if TYPE_CHECKING:
    from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import DynamicPlant

__all__ = ["SimulatedRobot"]

_NANO = 1_000_000_000


class SimulatedRobot:
    """A follower that understands messages.

    Cycles come from another thread than callbacks: its lock is to be held while it or its follower
    is used, other than by `execute`.

    Parameters
    ----------
    chain : SerialChain
        The robot.
    settings : ControllerSettings
        Parameters of the node.
    clock : MotionClock
        The time.

    Attributes
    ----------
    lock : RLock
        To be held while the robot is used.
    counts : MotionCounts
        What has become of trajectories so far.
    simulated_joints : SimulatedJoints
        The joints themselves.
    follower : Follower
        What moves them.
    refuse_all : str
        Why no trajectory is accepted any more; empty while trajectories are accepted.

    Raises
    ------
    ParameterError
        The initial position does not fit the robot, or parameters do not go together.
    MissingInertiaError, BadValueError
        The robot is to be simulated with its dynamics, and its bodies are not known or impossible.
    """

    def __init__(
        self, chain: SerialChain, settings: ControllerSettings, clock: MotionClock
    ) -> None:
        self.chain = chain
        self.joint_names = list(chain.joint_names)
        self.lock = threading.RLock()
        self.counts = MotionCounts()
        self.refuse_all = ""
        self._settings = settings
        self._clock = clock
        check_simulation(settings)
        self._initial = initial_position(settings, chain)
        self._plant = _dynamic_plant(chain, settings, self._initial)
        self._tolerances = default_tolerances(settings, chain.n)
        self.simulated_joints = SimulatedJoints(self._initial, settings.tracking_lag, self._plant)
        self.follower = Follower(
            Joints.of(chain), self.simulated_joints, follower_settings(settings), clock.now()
        )
        clock.on_jump(self.follower.clock_jumped)

    @property
    def dynamic(self) -> bool:
        """Whether forces move it."""
        return self._plant is not None

    def unlimited_joints(self) -> list[str]:
        """Name the joints that forces without a limit move."""
        limited = np.isfinite(self.chain.effort) | (not self.dynamic)
        return [self.joint_names[int(joint)] for joint in np.flatnonzero(~limited)]

    def saturation(self) -> str:
        """Say which drives were at their limits since the last motion began; empty for none."""
        return saturation_text(self.simulated_joints.at_limit, self.joint_names)

    def carry(self, settings: ControllerSettings) -> None:
        """Have it carry the payload of these settings from now on."""
        if self._plant is not None:
            self._plant.carry(settings)

    def advance(self) -> None:
        """Move on to the present time."""
        self.follower.advance(self._clock.now())

    def stamp(self) -> tuple[int, int]:
        """Give the ROS time (s and ns) of the follower's states, which may be some time ago."""
        return divmod(max(self._clock.stamp(self.follower.now), 0), _NANO)

    def execute(
        self,
        trajectory: JointTrajectory,
        by: str,
        on_end: Callable[[GoalResult], None],
        tolerances: Callable[[Tolerances], Tolerances] = lambda default: default,
    ) -> TrajectoryGoal:
        """Execute a trajectory from now on, or from its stamp on.

        Parameters
        ----------
        trajectory : JointTrajectory
            From outside.
        by : str
            Who sent it, for the text of the motion that it replaces.
        on_end : callable
            Called once, with the result.
        tolerances : callable, optional
            Makes the tolerances of the motion from those that hold by default.

        Returns
        -------
        TrajectoryGoal

        Raises
        ------
        RobomechError
            It is refused; the present motion goes on.
        """
        try:
            waypoints = self._read(trajectory)
            held_to = tolerances(self._tolerances)

            def end(result: GoalResult) -> None:
                self.counts.end(result)
                on_end(result)

            with self.lock:
                now = self._clock.now()
                delay = self._clock.until(trajectory.header.stamp, now)
                goal = self.follower.start(waypoints, held_to, now, delay, end, by)
                self.counts.accept()
                return goal
        except RobomechError as error:
            with self.lock:
                self.counts.refuse(code_of(error), str(error), trajectory_label(trajectory))
            raise

    def _read(self, trajectory: JointTrajectory) -> Waypoints:
        """Check a trajectory; cycles go on while a long one is read, so without the lock."""
        if self.refuse_all:
            raise TrajectoryRefusedError(self.refuse_all)
        settings = self._settings
        return read_waypoints(
            received_trajectory(trajectory),
            self.joint_names,
            settings.max_points,
            settings.max_duration,
            partial=settings.allow_partial_joints_goal,
            to_rest=not settings.allow_nonzero_velocity_at_trajectory_end,
        )

    def reset(self, text: str) -> None:
        """Put the robot back to where it was at start, at once."""
        self.follower.reset(self._initial, text)


def _dynamic_plant(
    chain: SerialChain, settings: ControllerSettings, position: NDArray[np.float64]
) -> "DynamicPlant | None":
    """Make the drives and what they move; None where no forces are simulated."""
    if settings.simulation != DYNAMIC:
        return None
    # Compiled code is loaded only where it is needed.
    from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import DynamicPlant

    return DynamicPlant(chain, settings, position)
