"""Getting joints in motion onto the way for a twist, a part of the work in each period."""

from collections.abc import Callable

from robomech_ros.servo.line_path import LinePath
from robomech_ros.servo.motion import Advance
from robomech_ros.servo.stream import JOINING_TIMES, Stream

# A twist must have been held for so many periods before joints that move get onto its way.
_HELD = 5
# In so many periods the beginning of a way must have been laid.
_PATIENCE = 15
# So many periods pass before the next way is laid, each at this part of the speed: slowly enough
# it succeeds.  Where a way leads nowhere, more of them.
_AGAIN, _AGAIN_HOPELESS, _SLOWER = 2, 20, 0.85


class LineEntry:
    """Looks for a motion of the joints onto the way for a twist that is held.

    Meanwhile the twist is followed at the part ``slower`` of its speed.
    """

    def __init__(self) -> None:
        self._path: LinePath | None = None
        self._tried = self._waited = 0
        self.begin()

    def begin(self) -> None:
        """Begin again, for another twist."""
        self._path, self.slower = None, 1.0
        self._held = self._pause = 0

    def attempt(self, stream: Stream, share: float, lay: Callable[[], LinePath]) -> Advance | None:
        """Go on by a period onto the way, if there is a motion onto it.

        The stream is in motion, along no way; a share of the twist is wanted, and ``lay`` gives the
        way from the latest knot.
        """
        self._held += 1
        if self._held < _HELD:
            return None
        if self._pause:
            self._pause -= 1
            return None
        if self._path is None:
            self._path, self._tried, self._waited = lay(), 0, 0
        path = self._path
        path.begin_period()
        joined = stream.join(path, share, JOINING_TIMES[self._tried])
        if joined is not None:
            self.begin()
            return joined
        if path.unfinished and self._waited < _PATIENCE:
            self._waited += 1
            return None
        self._tried += 1
        if path.hopeless or path.unfinished or self._tried == len(JOINING_TIMES):
            self._path, self._pause = None, _AGAIN_HOPELESS if path.hopeless else _AGAIN
            if stream.moves_along(path) and not path.hopeless:
                self.slower *= _SLOWER
        return None
