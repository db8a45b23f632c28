"""The tree of frames that tf describes: every frame with its parent, as far back as is known."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.frames.history import FrameHistory, Sample
from robomech_ros.spatial.poses import assembled, rigid_inverse
from robomech_ros.spatial.rotations.quaternions import matrix_from_quaternion
from robomech_ros.typing import Array

# More than any robot has: what a faulty sender can fill is bounded.
MOST_FRAMES = 1000
_MOST_SAMPLES = 100_000
_LONGEST_NAME = 255
# As tf2 has it: how far the squared norm of a quaternion may be from 1.
_QUATERNION_SQUARED = 1e-2
_NANO = 1e-9


class NoTransformError(RobomechError):
    """tf does not say where a frame is in another one."""

    def __init__(self, why: str, may_come: bool = True) -> None:
        self.may_come = may_come  #: Whether the next messages may change that.
        super().__init__(why)


class TransformResult(NamedTuple):
    """Pose of a frame in another one."""

    pose: Array  #: Pose of the source in the target (m), shape (4, 4).
    stamp: int | None  #: ROS time (ns) of the pose; None if all frames are static.
    slowest: str  #: Frame with the oldest latest transform; empty if all are static.


class FrameTree:
    """Frames, their parents, and their poses over the last seconds.

    Messages may have any content: circles of frames are detected, and memory is bounded.
    """

    def __init__(self) -> None:
        self._histories: dict[str, FrameHistory] = {}
        self._count = 0

    def __contains__(self, frame: str) -> bool:
        return frame in self._histories or frame in self._parents()

    @property
    def frames(self) -> tuple[str, ...]:
        """All frames, by name."""
        return tuple(sorted(self._parents() | self._histories.keys()))

    def _parents(self) -> set[str]:
        return {history.last.parent for history in self._histories.values()}

    def insert(self, child: str, sample: Sample, now: int, *, static: bool) -> str:
        """Add a pose of a frame in its parent.

        - ``sample``: the pose; a quaternion near unit length is normalised.
        - ``now``: present ROS time (ns).
        - ``static``: whether the pose holds at all times.

        Returns why the pose was ignored; empty if it was added.
        """
        if fault := self._fault_of(child, sample):
            return fault
        norm = math.sqrt(sum(number * number for number in sample.turn))
        sample = sample._replace(turn=tuple(number / norm for number in sample.turn))
        history = self._histories.setdefault(child, FrameHistory())
        before = len(history)
        if static:
            history.fix(sample)
        else:
            history.add(sample, now)
        self._count += len(history) - before
        if self._count > _MOST_SAMPLES and len(history) > 1:
            history.forget_oldest()
            self._count -= 1
        return ""

    def _fault_of(self, child: str, sample: Sample) -> str:
        """Say why a transform is none, or one too many."""
        parent, shown = sample.parent, f"the transform of {child[:50]!r} in {sample.parent[:50]!r}"
        if not child or not parent or child == parent:
            return f"{shown}: a frame and its parent need two names"
        if max(len(child), len(parent)) > _LONGEST_NAME:
            return f"{shown}: a name of more than {_LONGEST_NAME} characters"
        if not all(map(math.isfinite, (*sample.place, *sample.turn))):
            return f"{shown}: a number that is not finite"
        if max(map(abs, sample.place)) > LARGEST_LENGTH:
            return f"{shown}: more than {LARGEST_LENGTH:g} m away"
        squared = sum(number * number for number in sample.turn)
        if abs(squared - 1.0) > _QUATERNION_SQUARED:
            return f"{shown}: its quaternion has norm {math.sqrt(squared):.6g}, expected 1"
        if child not in self._histories and len(self._histories) >= MOST_FRAMES:
            return f"{shown}: there are {MOST_FRAMES} frames already, the most that are kept"
        return ""

    def forget_moving(self) -> None:
        """Drop all frames that are not static; to be called when time restarts."""
        self._histories = {child: h for child, h in self._histories.items() if h.static}
        self._count = len(self._histories)

    def path_to_root(self, frame: str, stamp: int | None = None) -> list[str]:
        """List a frame, its parent and so on up to the root of its tree.

        - ``stamp``: instant (ns) for frames that change their parents; default the last received.

        Raises NoTransformError: there is no such frame, or its parents form a circle.
        """
        if frame not in self:
            text = f"tf has no frame {frame[:200]!r}" if self._histories else "tf has no frames yet"
            raise NoTransformError(text)
        path = {frame: None}
        while frame in self._histories:
            history = self._histories[frame]
            frame = (history.last if stamp is None else history.at(stamp)).parent
            if frame in path:
                circle = [*path][[*path].index(frame) :]
                shown = ", ".join(circle[:5]) + (", ..." if len(circle) > 5 else "")
                raise NoTransformError(f"tf goes round in a circle: {shown}, {frame}")
            path[frame] = None
        return [*path]

    def between(self, target: str, source: str, stamp: int | None = None) -> TransformResult:
        """Find where a frame is in another one.

        - ``stamp``: instant (ns); default the last received for every frame on the path.

        Raises NoTransformError: a frame is not known, the two belong to different trees, the way is
        a circle, or the instant is not among those kept.
        """
        up, down = self._paths(target, source, stamp)
        moving = [frame for frame in (*up, *down) if not self._histories[frame].static]
        if not moving:
            return TransformResult(self._pose(up, down, 0), None, "")
        slowest = min(moving, key=lambda frame: self._histories[frame].last.stamp)
        if stamp is None:
            stamp = self._histories[slowest].last.stamp
            # A frame may have had another parent then.
            up, down = self._paths(target, source, stamp)
        else:
            self._check_kept(moving, slowest, stamp)
        return TransformResult(self._pose(up, down, stamp), stamp, slowest)

    def _paths(self, target: str, source: str, stamp: int | None) -> tuple[list[str], list[str]]:
        """List the frames from the source and from the target to below where they meet."""
        from_source = self.path_to_root(source, stamp)
        from_target = self.path_to_root(target, stamp)
        shared = set(from_source).intersection(from_target)
        if not shared:
            raise NoTransformError(
                f"tf has two trees that are not connected: {source!r} hangs on "
                f"{from_source[-1]!r}, {target!r} on {from_target[-1]!r}"
            )
        up, down = (
            [frame for frame in path if frame not in shared] for path in (from_source, from_target)
        )
        return up, down

    def _check_kept(self, moving: Sequence[str], slowest: str, stamp: int) -> None:
        """Refuse an instant that is newer or older than what is known."""
        last = self._histories[slowest].last
        if stamp > last.stamp:
            ahead = (stamp - last.stamp) * _NANO
            raise NoTransformError(
                f"the stamp is {ahead:.3g} s newer than what tf last said of {slowest!r} in "
                f"{last.parent!r}; stamp 0 takes the latest"
            )
        youngest = max(moving, key=lambda frame: self._histories[frame].first.stamp)
        first = self._histories[youngest].first
        if stamp < first.stamp:
            late = (first.stamp - stamp) * _NANO
            why = (
                f"the stamp is {late:.3g} s older than what is kept of {youngest!r} in "
                f"{first.parent!r}"
            )
            raise NoTransformError(why, may_come=False)

    def _pose(self, up: Sequence[str], down: Sequence[str], stamp: int) -> Array:
        return rigid_inverse(self._product(down, stamp)) @ self._product(up, stamp)

    def _product(self, path: Sequence[str], stamp: int) -> Array:
        """Return the pose of the first frame of a way in the parent of the last."""
        pose = np.eye(4)
        for frame in path:
            sample = self._histories[frame].at(stamp)
            pose = assembled(matrix_from_quaternion(sample.turn), np.array(sample.place)) @ pose
        return pose
