"""Recent poses of one tf frame in its parent."""

from bisect import bisect_left
from operator import attrgetter
from typing import NamedTuple

from robomech_ros.spatial import slerp

# How long transforms are kept, ns: as long as tf2 keeps them.
WINDOW = 10_000_000_000
# Most samples of a frame: 100 per second for that time.
_MOST_SAMPLES = 1000
_STAMP = attrgetter("stamp")


class Sample(NamedTuple):
    """Pose of a frame in its parent at an instant."""

    stamp: int  #: ns of ROS time.
    parent: str
    place: tuple[float, ...]  #: Origin of the frame in the parent (m).
    turn: tuple[float, ...]  #: Orientation, a unit quaternion x, y, z, w.


class FrameHistory:
    """The samples of one frame, in the order of their stamps, or one that holds for ever."""

    def __init__(self) -> None:
        self.static = False  #: Whether its one sample holds at every instant.
        self._samples: list[Sample] = []

    def __len__(self) -> int:
        return len(self._samples)

    @property
    def first(self) -> Sample:
        """The oldest sample."""
        return self._samples[0]

    @property
    def last(self) -> Sample:
        """The newest sample."""
        return self._samples[-1]

    def fix(self, sample: Sample) -> None:
        """Keep this sample alone, for every instant."""
        self.static = True
        self._samples = [sample]

    def add(self, sample: Sample, now: int) -> None:
        """Keep a sample; what is older than the window before the newest is let go.

        - ``now``: ROS time (ns). Samples from farther ahead than the window give way to one that is
          not: the clock of their sender was wrong, or simulated time began anew.
        """
        samples = self._samples
        if self.static:
            self.static = False
            samples.clear()
        if samples and sample.stamp < samples[-1].stamp - WINDOW:
            if samples[-1].stamp <= now + WINDOW:
                return
            samples.clear()
        at = bisect_left(samples, sample.stamp, key=_STAMP)
        if at < len(samples) and samples[at].stamp == sample.stamp:
            samples[at] = sample
        else:
            samples.insert(at, sample)
        oldest = samples[-1].stamp - WINDOW
        gone = max(bisect_left(samples, oldest, key=_STAMP), len(samples) - _MOST_SAMPLES)
        del samples[:gone]

    def forget_oldest(self) -> None:
        """Drop the oldest sample."""
        del self._samples[0]

    def at(self, stamp: int) -> Sample:
        """Return the sample at an instant (ns): between two samples in between, as tf2 has it.

        Before the first sample that is the first, behind the last the last; between samples with
        different parents the one before.
        """
        samples = self._samples
        k = bisect_left(samples, stamp, key=_STAMP)
        if k == len(samples):
            return samples[-1]
        if k == 0 or samples[k].stamp == stamp:
            return samples[k]
        before, behind = samples[k - 1], samples[k]
        if before.parent != behind.parent:
            return before
        part = (stamp - before.stamp) / (behind.stamp - before.stamp)
        place = tuple(a + part * (b - a) for a, b in zip(before.place, behind.place, strict=True))
        turn = slerp(before.turn, behind.turn, part)
        return Sample(stamp, before.parent, place, tuple(turn.tolist()))
