"""One sample: where the hand is and where the sensor sees its target, while the robot stands."""

import time
from collections.abc import Callable

import numpy as np
from rclpy.node import Node

from robomech_ros.nodes.calibration.pose_history import PoseTrack
from robomech_ros.nodes.calibration.settings import CalibrationSettings
from robomech_ros.nodes.common.cooperative_wait import pause
from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.frames.tree import NoTransformError
from robomech_ros.outcomes import Code
from robomech_ros.spatial import pose_error
from robomech_ros.typing import Array

# So many places of the hand are compared over the time in which it has to stand.
_SAMPLES = 11


class Sampler:
    """Takes samples from two tracks.

    - ``node``: gives the clock, and serves other requests meanwhile.
    - ``robot``: poses of the hand in the robot's base.
    - ``tracking``: poses of the target in the sensor's frame.
    """

    def __init__(
        self,
        node: Node,
        robot: PoseTrack,
        tracking: PoseTrack,
        settings: Callable[[], CalibrationSettings],
    ) -> None:
        self._node, self._robot, self._tracking = node, robot, tracking
        self._settings = settings

    async def take(self, patience: float) -> tuple[Array, Array]:
        """Wait for a sample of an instant after this call, up to `patience` (s).

        Returns ``T_base_hand`` and ``T_sensor_target``, (4, 4) each (m), at that instant.

        Raises OutcomeError: a pose is missing, or older than the call; or the robot moved all that
        time.
        """
        asked, deadline = self._now(), time.monotonic() + patience
        instant: int | None = None
        while True:
            self._robot.look()
            self._tracking.look()
            try:
                # One instant is waited for until the robot's pose of it is known, too: a fast
                # sensor would always be ahead.
                if instant is None:
                    seen = self._known_until(self._tracking)
                    if seen < asked:
                        raise self._too_old(self._tracking, asked)
                    instant = seen
                if self._known_until(self._robot) >= instant:
                    return self._sample(instant)
                refusal = self._too_old(self._robot, instant)
            except OutcomeError as error:
                instant, refusal = None, error
            if time.monotonic() >= deadline:
                raise refusal
            await pause(self._node)

    def _now(self) -> int:
        return int(self._node.get_clock().now().nanoseconds)

    def _known_until(self, track: PoseTrack) -> int:
        """Return the latest instant with a pose: now for what does not change."""
        try:
            last = track.last()
        except NoTransformError as error:
            raise _no_pose(track, f"{error}{track.context()}") from None
        return self._now() if last is None else last

    def _too_old(self, track: PoseTrack, wanted: int) -> OutcomeError:
        age = (wanted - self._known_until(track)) / NANO
        hint = "of the request; does the sensor see the target?"
        if track is self._robot:
            hint = "of the target's; do two clocks differ?"
        return _no_pose(track, f"the last is from {age:.3g} s before the time {hint}")

    def _sample(self, instant: int) -> tuple[Array, Array]:
        """Return both poses at an instant, unless the hand moved just before."""
        settings = self._settings()
        before = np.linspace(settings.still_time, 0.0, _SAMPLES) * NANO
        try:
            poses = np.array([self._robot.at(instant - round(back)) for back in before.tolist()])
        except NoTransformError as error:
            why = f"{error}: it has to stand for {settings.still_time:g} s"
            raise _no_pose(self._robot, why) from None
        moved = pose_error(poses[-1], poses)
        angle, distance = (
            float(np.linalg.norm(part, axis=1).max()) for part in (moved[:, :3], moved[:, 3:])
        )
        if distance > settings.still_distance or angle > settings.still_angle:
            rest = f"{settings.still_distance:g} m and {settings.still_angle:g} rad"
            text = (
                f"the robot moves: its hand moved {distance:.3g} m and turned {angle:.3g} rad "
                f"within {settings.still_time:g} s, at rest is up to {rest} (still_distance, "
                "still_angle); ask again when it stands"
            )
            raise OutcomeError(Code.NO_STATE, text)
        try:
            return poses[-1], self._tracking.at(instant)
        except NoTransformError as error:
            raise _no_pose(self._tracking, str(error)) from None


def _no_pose(track: PoseTrack, why: str) -> OutcomeError:
    return OutcomeError(Code.FRAME_UNAVAILABLE, f"{track.what}: {why}")
