"""Poses of requested frames: frames of the robot, and those that tf connects with it."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from rclpy.node import Node

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.cooperative_wait import pause
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.error_codes import FrameUnavailableError
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.robot.robot_description import FrameSettings, RobotModel
from robomech_ros.nodes.frames.history import WINDOW
from robomech_ros.nodes.frames.listener import FrameListener
from robomech_ros.nodes.frames.tree import NoTransformError, TransformResult
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# Joint name to position (rad or m), or to positions, shape (...), in as many states.
Positions = Mapping[str, Any]

# Some senders date their news ahead, so that they hold until the next ones; from farther ahead, s,
# they would never get too old.
_MAX_AHEAD = WINDOW / NANO
# Longest wait (s) for an unknown frame after other frames have been received.
_UNKNOWN_FRAME_WAIT = 0.5


@dataclass(frozen=True, eq=False)
class FrameAttachment:
    """Location of a frame, as far as joints do not move it."""

    #: Chain from the base to the link that carries the frame; None if that is the base.
    chain: SerialChain | None
    #: Pose (4, 4) of the frame in that link (m).
    offset: Array

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The joints that move it."""
        return () if self.chain is None else self.chain.joint_names

    def pose(self, positions: Positions) -> Array:
        """Return its pose in the base at positions by joint.

        It is of shape (..., 4, 4) where joints move it, else of (4, 4) (m).
        """
        if self.chain is None:
            return self.offset
        values = np.broadcast_arrays(*[positions[name] for name in self.chain.joint_names])
        return self.pose_at(np.stack(values, axis=-1))

    def pose_at(self, q: Array) -> Array:
        """Return the same at joint values (..., n) of its chain."""
        if self.chain is None:
            return self.offset
        return forward_kinematics(self.chain, q) @ self.offset


_BASE = FrameAttachment(None, np.eye(4))


class RobotFrames:
    """Finds the frames that requests name.

    Links of the robot come from its description and the joints; any other frame from tf, by the
    link that carries it or by the base.
    """

    def __init__(
        self,
        node: Node,
        model: RobotModel,
        monitor: JointStateMonitor,
        settings: Callable[[], FrameSettings],
    ) -> None:
        self._node, self.model, self.monitor = node, model, monitor
        self._settings = settings
        self._listener = FrameListener(node)

    def find(self, frame: str, stamp: Time | None = None) -> FrameAttachment:
        """Find a frame in what is known now.

        - ``frame``: "" is the base.
        - ``stamp``: instant at which the frame was there, for frames that move; 0 or None is now.

        Raises FrameUnavailableError: neither the robot has it nor tf, or tf does not connect it
        with the robot, or not at this instant, or its news are too old.
        """
        try:
            return self._find(frame, _instant(stamp))
        except NoTransformError as error:
            raise self._unavailable(frame, error) from None

    async def place(
        self, frame: str, patience: float, stamp: Time | None = None
    ) -> FrameAttachment:
        """Find a frame as `find` does, and wait for it, up to `patience` (s).

        A frame that is nowhere in tf is waited for no longer than half a second, as soon as tf has
        had others for that long.

        Raises FrameUnavailableError.
        """
        instant, begun = _instant(stamp), time.monotonic()
        while True:
            try:
                return self._find(frame, instant)
            except NoTransformError as error:
                end = begun + patience
                if self.model.full_frame(frame) not in self._listener.tree:
                    end = min(end, max(begun, self._listener.receiving_since) + _UNKNOWN_FRAME_WAIT)
                if not error.may_come or time.monotonic() >= end:
                    raise self._unavailable(frame, error) from None
            await pause(self._node)

    async def in_base(
        self, frame: str, patience: float, stamp: Time | None = None, at: Positions | None = None
    ) -> Array:
        """Return the pose of a frame in the base, (4, 4) (m).

        - ``patience``: how long to wait for the frame, and for the joints that move it (s).
        - ``stamp``: as for `find`.
        - ``at``: positions (rad or m) of joints that are not to be the present ones; with positions
          in many states the pose is of shape (..., 4, 4), where these joints move it.

        Raises FrameUnavailableError: as `find` raises it. NoStateError: joints move the frame, and
        where they are is not known.
        """
        if not frame:
            return _BASE.offset
        place = await self.place(frame, patience, stamp)
        given = at or {}
        missing = [name for name in place.joint_names if name not in given]
        if not missing:
            return place.pose(given)
        present = (await self.monitor.wait_for(missing, patience)).tolist()
        return place.pose({**given, **dict(zip(missing, present, strict=True))})

    def is_apart(self, frame: str) -> bool:
        """Return whether a known frame is independent of the robot: no link carries it in tf."""
        link = self.model.link_of(frame)
        if not link or link in self.model.description.links:
            return False
        path = self._listener.tree.path_to_root(self.model.full_frame(frame), None)
        links = set(map(self.model.frame_of, self.model.description.links))
        return links.isdisjoint(path)

    def _find(self, frame: str, instant: int | None) -> FrameAttachment:
        model, tree = self.model, self._listener.tree
        link = model.link_of(frame)
        if not link or link == model.chain.base:
            return _BASE
        own = self._place_of_link(link)
        if own is not None and own.chain is None:
            return own
        self._listener.look()
        known_as = model.full_frame(frame)
        if own is not None and (instant is None or known_as not in tree):
            return own
        virtual, root = model.virtual_frames.get(known_as), self._root_of(known_as)
        # Whoever publishes where the robot stands goes before its SRDF.
        if virtual is not None and (root is None or root != self._root_of(model.base_frame)):
            return FrameAttachment(None, virtual)
        if self._listener.missing:
            raise NoTransformError(self._listener.missing, may_come=False)
        return self._by_tf(known_as, instant)

    def _place_of_link(self, link: str) -> FrameAttachment | None:
        """Find a link of the robot; None if it is not a link, or has no chain from the base."""
        fixed = self.model.fixed_frames
        if link in fixed:
            return FrameAttachment(None, fixed[link])
        if link not in self.model.description.links:
            return None
        try:
            return FrameAttachment(self.model.chain_to(link), np.eye(4))
        except RobotDescriptionError:
            return None

    def _by_tf(self, frame: str, instant: int | None) -> FrameAttachment:
        """Find a frame of tf by the links of the robot that tf connects with it."""
        tree, model = self._listener.tree, self.model
        path = tree.path_to_root(frame, instant)
        fixed = [model.base_frame, *map(model.frame_of, model.fixed_frames)]
        # Now is told best by the joints and the link that carries the frame, the past by tf alone.
        others = [*path, *fixed] if instant is None else [*fixed, *path]
        for other in dict.fromkeys([*others, *tree.frames]):
            if not other.startswith(model.frame_prefix):
                continue
            place = self._place_of_link(other.removeprefix(model.frame_prefix))
            if place is not None and self._root_of(other, instant) == path[-1]:
                return self._carried(place, tree.between(other, frame, instant), instant)
        for other, pose in model.virtual_frames.items():
            if self._root_of(other, instant) == path[-1]:
                found = tree.between(other, frame, instant)
                return self._carried(FrameAttachment(None, pose), found, instant)
        raise NoTransformError(self._not_connected(path))

    def _root_of(self, frame: str, instant: int | None = None) -> str | None:
        """Return the root of a frame in tf; None for an unknown frame, or a circle."""
        try:
            return self._listener.tree.path_to_root(frame, instant)[-1]
        except NoTransformError:
            return None

    def _not_connected(self, path: list[str]) -> str:
        """Say why a frame of tf leads to no link of the robot."""
        base = self.model.base_frame
        root = self._root_of(base)
        if root is not None:
            other = f"the base {base!r} hangs on {root!r}"
        elif base in self._listener.tree:
            other = f"the base {base!r} is on a circle"
        else:
            other = "tf has no link of the robot"
        return f"tf does not connect it with the robot: it hangs on {path[-1]!r}, {other}"

    def _carried(
        self, place: FrameAttachment, found: TransformResult, instant: int | None
    ) -> FrameAttachment:
        """Add to the place of a link what tf found in it, unless that is too old or to come."""
        if found.stamp is not None and instant is None:
            age = (self._listener.now - found.stamp) / NANO
            most = self._settings().max_transform_age
            if age > most:
                raise NoTransformError(
                    f"what tf last said of {found.slowest!r} is {age:.4g} s old, expected at most "
                    f"{most:g} s, the parameter max_transform_age"
                )
            if age < -_MAX_AHEAD:
                raise NoTransformError(
                    f"what tf last said of {found.slowest!r} is {-age:.4g} s ahead of the time "
                    f"here, expected at most {_MAX_AHEAD:g} s: two clocks differ"
                )
        return FrameAttachment(place.chain, place.offset @ found.pose)

    def _unavailable(self, frame: str, error: NoTransformError) -> FrameUnavailableError:
        """Say what was not found, and what there is."""
        why, listener, model = str(error), self._listener, self.model
        if not listener.missing and model.full_frame(frame) not in listener.tree:
            own = model.link_of(frame) in model.description.links
            link = "no chain from the base leads to it" if own else "the robot has no such link"
            why = f"{link}, and {why} on {listener.source}"
        links = [*model.fixed_frames, *model.description.links]
        usable = [model.frame_of(link) for link in links if self._place_of_link(link) is not None]
        usable += model.virtual_frames
        return FrameUnavailableError(frame, dict.fromkeys([*usable, *listener.tree.frames]), why)


def _instant(stamp: Time | None) -> int | None:
    """Return a stamp in ns; None for none and for 0, which both mean now."""
    return None if stamp is None else (stamp.sec * NANO + stamp.nanosec) or None
