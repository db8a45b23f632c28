"""The gripper of the simulated robot, as actions and trajectories command it."""

import re
import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from sensor_msgs.msg import JointState

from robomech_ros.errors import BadValueError, RobomechError, UnknownJointError
from robomech_ros.execution.controller.simulated_joints import Faults, SimulatedJoints
from robomech_ros.execution.controller.trajectory_goal import TrajectoryGoal
from robomech_ros.execution.gripper.finger_motion import FingerCommand, complete_limits
from robomech_ros.execution.gripper.finger_plant import Contact, FingerPlant
from robomech_ros.execution.gripper.fingers import Fingers, GripSettings
from robomech_ros.execution.gripper.received_command import CommandReader
from robomech_ros.execution.joints import Joints
from robomech_ros.nodes.common.messages.message_fields import floats
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.common.robot.gripper_names import known_finger_joints, listed_names
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.joint_trajectory_controller.commanded_joints import CommandedJoints
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.robots import Joint
from robomech_ros.robots.fingers import FingerOpening, finger_ends
from robomech_ros.robots.gripper import commanded_fingers
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import Array

_PARALLEL = "parallel_gripper_controller"
_NAME = re.compile(r"~?/?([A-Za-z_]\w*/)*[A-Za-z_]\w*", re.ASCII)


def gripper_of(
    model: RobotModel, settings: ControllerSettings, clock: MotionClock, lock: "threading.RLock"
) -> "Gripper | None":
    """Make the gripper behind the chain, or None; ParameterError for wrong parameters."""
    _check_places(settings)
    joints = known_finger_joints(model, settings)
    return Gripper(model, joints, settings, clock, lock) if joints else None


class Gripper(CommandedJoints):
    """Finger joints, which something between them may stop.

    - ``joints``: the n finger joints.
    - ``lock``: the lock of the arm.
    - ``allow_stalling``: whether a command succeeds if something stops the fingers.

    Raises ParameterError: parameters do not fit the robot.
    """

    def __init__(
        self,
        model: RobotModel,
        joints: Sequence[Joint],
        settings: ControllerSettings,
        clock: MotionClock,
        lock: "threading.RLock",
    ) -> None:
        self._model = model
        self._joints = tuple(joints)
        limits, strongest = _limits(joints), np.array([joint.effort for joint in joints])
        if settings.gripper_max_effort:
            strongest = np.fmin(strongest, settings.gripper_max_effort)
        complete = complete_limits(limits)
        initial = _at_rest(model, limits.joint_names)
        self._plant = FingerPlant(initial, complete, strongest)
        continuous = np.array([joint.type == "continuous" for joint in joints])
        simulated = SimulatedJoints(initial, 0.0, self._plant)
        place = settings.gripper_controller
        super().__init__(place, Joints(limits, continuous), simulated, settings, clock, lock)
        grip = GripSettings(
            settings.gripper_goal_tolerance,
            settings.gripper_stall_velocity_threshold,
            settings.gripper_stall_timeout,
        )
        #: Follow them; the lock is to be held while they are used.
        self.fingers = Fingers(self.follower, self._plant, complete, grip)
        #: The joints that a command moves which names none; empty where it has to name one.
        self.commanded = _commanded(joints, settings.gripper_joint)
        fastest = np.minimum(complete.velocity, settings.gripper_max_velocity or np.inf)
        #: Checks commands.
        self.reader = CommandReader(limits, self.commanded, fastest, strongest, self._posture)
        self.change(settings)

    def says(self) -> str:
        """Say in one line which joints there are, and what commands them."""
        names = ", ".join(self.joint_names)
        if not self.commanded:
            return f"{names}; gripper_cmd needs the parameter gripper_joint, or names"
        return f"{names}; {self.place}/gripper_cmd moves {', '.join(self.commanded)}"

    def check(self, settings: ControllerSettings) -> None:
        """Refuse an object that these fingers cannot hold."""
        self._contact(settings)

    def change(self, settings: ControllerSettings) -> None:
        """Take over the parameters that may change at run time; the lock is to be held."""
        self.allow_stalling = settings.gripper_allow_stalling
        self._plant.contact = self._contact(settings)
        stuck = np.isin(self.joint_names, listed_names(settings.fault_stuck_joints))
        self.simulated_joints.inject(Faults(stuck, np.zeros(len(stuck))))

    def close(self, why: str) -> None:
        """Refuse all commands from now on, slow down, and hold; what is gripped stays so."""
        super().close(why)
        self.fingers.close(why)

    def advance_to(self, time: float) -> None:
        """Move on to a time (s), and judge what has been commanded."""
        super().advance_to(time)
        self.fingers.look()

    def reset(self, text: str) -> None:
        """Put the joints back to where they were at start, at once."""
        super().reset(text)
        self.fingers.reset(text)

    def pressing(self) -> list[str]:
        """Name the joints that something stops; the lock is to be held."""
        return [self.joint_names[int(joint)] for joint in np.flatnonzero(self._plant.pressing)]

    def state_of(self, command: FingerCommand) -> JointState:
        """Return the state of the joints that a command is about; the lock is to be held."""
        moved, actual = command.moved, self.follower.actual
        effort = self.simulated_joints.effort
        assert effort is not None
        message = JointState(
            name=[self.joint_names[int(joint)] for joint in np.flatnonzero(moved)],
            position=floats(actual.position[moved]),
            velocity=floats(actual.velocity[moved]),
            effort=floats(effort[moved]),
        )
        message.header.stamp.sec, message.header.stamp.nanosec = self.stamp()
        return message

    def _posture(self, name: str) -> dict[str, float]:
        """Return a state of the SRDF that moves fingers alone, rad or m by joint with a drive."""
        semantic = self._model.semantic
        groups = semantic.postures_of(self.joint_names)
        if groups and name not in groups:
            raise BadValueError("posture of the gripper", name, f"one of {', '.join(groups)}")
        state = semantic.state(groups[name], name) if groups else {}
        return {joint: at for joint, at in state.items() if joint in self.joint_names}

    def _begin(self, start: Callable[[], TrajectoryGoal], by: str) -> TrajectoryGoal:
        return self.fingers.follow(start, by)

    def _contact(self, settings: ControllerSettings) -> Contact | None:
        """Find where the simulated object stops the fingers; None for nothing."""
        width = settings.gripper_object_width
        if not width:
            return None
        description = self._model.description
        joints = tuple(joint for joint in self._joints if joint.name in self.commanded)
        links = listed_names(settings.gripper_finger_links) or finger_ends(description, joints)
        try:
            opening = FingerOpening(description, joints, tuple(links))
        except RobomechError as error:
            raise ParameterError("gripper_object_width", width, f"0, as {error}") from None
        try:
            position = opening.position(width)
        except BadValueError as error:
            raise ParameterError("gripper_object_width", width, error.expected) from None
        stopped = np.isin(self.joint_names, self.commanded)
        return Contact(np.where(stopped, position, np.nan), np.full(len(stopped), opening.closing))


def _check_places(settings: ControllerSettings) -> None:
    """Refuse names below which the gripper cannot have two actions of the same name."""
    single, parallel = settings.gripper_controller, settings.parallel_gripper_controller
    for parameter, name in (("gripper_controller", single), (_PARALLEL, parallel)):
        if not _NAME.fullmatch(name):
            allowed = "words of letters, digits and underscores, with / between"
            raise ParameterError(parameter, name, allowed)
    if single == parallel:
        allowed = "another name than that of gripper_controller: an action has one type"
        raise ParameterError(_PARALLEL, parallel, allowed)


def _limits(joints: Sequence[Joint]) -> Limits:
    kinds = ("velocity", "acceleration", "jerk", "lower", "upper")
    rows: dict[str, Any] = {kind: [getattr(joint, kind) for joint in joints] for kind in kinds}
    units = tuple(joint.unit for joint in joints)
    return Limits(tuple(joint.name for joint in joints), **rows, units=units)


def _at_rest(model: RobotModel, names: Sequence[str]) -> Array:
    """Return where joints stand to begin with, rad or m."""
    description = model.description
    home = {name: description.home[name] for name in names if name in description.home}
    positions = description.joint_positions(home)
    return np.array([positions[name] for name in names])


def _commanded(joints: Sequence[Joint], named: str) -> tuple[str, ...]:
    try:
        return tuple(joint.name for joint in commanded_fingers(joints, named))
    except UnknownJointError as error:
        allowed = f"one of {', '.join(error.available)}, or empty"
        raise ParameterError("gripper_joint", named, allowed) from None
