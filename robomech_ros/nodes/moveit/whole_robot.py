"""The whole robot in MoveIt's messages: a position for every joint, a pose for every link."""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, UnknownJointError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state, values_by_name
from robomech_ros.nodes.common.messages.message_fields import finite_number
from robomech_ros.nodes.frames.robot_frames import FrameAttachment, RobotFrames
from robomech_ros.robots import SerialChain
from robomech_ros.spatial import inverse_pose
from robomech_ros.typing import Array

# Joint name to position (rad or m).
Positions = Mapping[str, float]


class WholeRobot:
    """Reads and writes the RobotState of a robot.

    Joints that follow another are no part of it: MoveIt derives them from the joint they follow.

    - ``frames``: frames of the robot in its present state.
    - ``attached``: returns the attached objects of the planning scene by name.
    """

    def __init__(self, frames: RobotFrames, attached: Callable[[], Mapping[str, Any]]) -> None:
        self._frames, self._monitor, self._attached = frames, frames.monitor, attached
        self.model = model = frames.model
        self._followers = {j.name for j in model.description.joints if j.mimic is not None}
        self.joint_names = [name for name in model.joint_names if name not in self._followers]
        limits = {joint.name: (joint.lower, joint.upper) for joint in model.description.joints}
        #: Joints that turn without limits.
        self.continuous = {j.name for j in model.description.joints if j.type == "continuous"}
        self._middle = {name: _middle(*limits[name]) for name in self.joint_names}

    def read(self, state: Any, what: str = "robot_state") -> dict[str, float]:
        """Read the positions (rad or m) that a RobotState gives, by joint.

        - ``state``: RobotState.
        - ``what``: name of the state in the request.

        Raises BadValueError: the state has objects that are not attached in the planning scene.
        UnknownJointError: the state has invalid entries for joints.
        """
        for one in state.attached_collision_objects:
            if one.object.id not in self._attached():
                expected = "an object that is attached in the planning scene; attach it there"
                name = f"{what}.attached_collision_objects: id"
                raise BadValueError(name, one.object.id, expected)
        compound = state.multi_dof_joint_state
        for field in ("joint_names", "transforms", "twist", "wrench"):
            entries = getattr(compound, field)
            if entries:
                given = list(compound.joint_names) or f"a list of length {len(entries)}"
                expected = "none: the robot has no joint of several freedoms"
                raise BadValueError(f"{what}.multi_dof_joint_state.{field}", given, expected)
        joints = state.joint_state
        values = values_by_name(joints.name, joints.position, f"{what}.joint_state")
        for name, value in values.items():
            if name not in self._middle and name not in self._followers:
                raise UnknownJointError(name, self.joint_names)
            finite_number(f"{what} of joint '{name}'", value)
        return {name: value for name, value in values.items() if name in self._middle}

    async def start(self, state: Any, needed: Iterable[str], settings: Any) -> dict[str, float]:
        """Read the start_state of a request, which must be at rest.

        - ``state``: RobotState.
        - ``needed``: joints that the plan needs.
        - ``settings``: MoveGroupSettings; they hold the time-out for the present state, and the
          tolerance of velocities at rest.

        Raises RobomechError: see `read` and `with_needed`; BadValueError for a joint that moves.
        """
        given, tolerance = self.read(state, "start_state"), settings.stopped_velocity_tolerance
        joints = state.joint_state
        for k, speed in enumerate(joints.velocity):
            name = joints.name[k] if k < len(joints.name) else f"number {k}"
            what = f"start_state: velocity of joint '{name}'"
            if abs(finite_number(what, speed)) > tolerance:
                unit = self.model.units.get(name, "rad")
                expected = f"at most {tolerance:g} {unit}/s: every plan starts at rest"
                raise BadValueError(what, speed, expected)
        needed = dict.fromkeys(needed)
        return await self.with_needed(given, needed, settings.state_timeout, tolerance)

    async def with_needed(
        self, given: Positions, needed: Iterable[str], patience: float, tolerance: float = math.inf
    ) -> dict[str, float]:
        """Add the present position of every joint that is not given.

        - ``given``: positions (rad or m) by joint.
        - ``needed``: joints that an answer cannot do without.
        - ``patience``: how long to wait for the present state of those (s).
        - ``tolerance``: speed up to which those that are not given stand (rad/s or m/s); default
          any.

        Raises NoStateError: a joint that is needed is not given, and its present position is not
        known. RobotMovesError: such a joint moves.
        """
        missing = [name for name in needed if name not in given]
        if missing:
            await self._monitor.wait_for(missing, patience, tolerance, self.model.units)
        return {**self.known(), **given}

    def known(self) -> dict[str, float]:
        """Return the present positions (rad or m) of the joints that are known."""
        return self._monitor.known_positions(self.joint_names)

    def with_defaults(self, positions: Positions) -> dict[str, float]:
        """Add the middle of its range for every joint whose position is not known."""
        return {**self._middle, **positions}

    def state(self, positions: Positions) -> Any:
        """Make the joint_state of a RobotState from the positions (rad or m) that are known."""
        names = [name for name in self.joint_names if name in positions]
        message = joint_state(names, np.array([positions[name] for name in names]))
        message.header.frame_id = self.model.base_frame
        return message

    def joints_to(self, frame: str) -> tuple[str, ...]:
        """Name the joints between the base and a link; of a frame fixed to the base, none."""
        if self.model.link_of(frame) in self.model.fixed_frames:
            return ()
        return self.model.chain_to(frame).joint_names

    async def places(self, frames: Iterable[str], patience: float) -> dict[str, FrameAttachment]:
        """Find the frames of poses; as in MoveIt where they are now, whatever their stamps.

        - ``frames``: "" is the base.
        - ``patience``: how long to wait for each (s).
        """
        return {frame: await self._frames.place(frame, patience) for frame in set(frames)}

    def joints_to_base_of(self, chain: SerialChain) -> tuple[str, ...]:
        """Name the joints between the configured base and the base of another chain.

        Of one that follows another, it is the one that leads.
        """
        if chain.base in self.model.fixed_frames:
            return ()
        description = self.model.description
        up, down = description.joints_between(self.model.chain.base, chain.base)
        leaders = {name: one.leader for name, one in description.followers.items()}
        moving = [joint.name for joint in (*up, *down) if joint.moves]
        return tuple(dict.fromkeys(leaders.get(name, name) for name in moving))

    def in_base_of(self, chain: SerialChain, pose: Array, positions: Positions) -> Array:
        """Return a pose (4, 4) in the configured base in the base of a chain of this robot (m).

        Positions (rad or m) are needed of the joints in between.
        """
        base, fixed = self.model.chain.base, self.model.fixed_frames
        if chain.base == base:
            return pose
        if chain.base in fixed:
            between = fixed[chain.base]
        else:
            poses = self.model.description.link_poses(positions)
            between = inverse_pose(poses[base]) @ poses[chain.base]
        return np.asarray(inverse_pose(between) @ pose)

    def pose(self, link: str, positions: Positions) -> Array:
        """Return the pose of a link in the base, shape (4, 4) (m)."""
        fixed = self.model.fixed_frames.get(self.model.link_of(link))
        if fixed is not None:
            return fixed
        way = self.model.chain_to(link)
        return forward_kinematics(way, np.array([positions[name] for name in way.joint_names]))


def _middle(lower: float, upper: float) -> float:
    if np.isfinite(lower) and np.isfinite(upper):
        return 0.5 * (lower + upper)
    return float(np.clip(0.0, lower, upper))
