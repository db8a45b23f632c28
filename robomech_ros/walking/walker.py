"""A legged robot that walks as it is commanded, one period after the other."""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.walking import gait_step
from robomech_ros._kernels.walking.gait_step import State, Step, StepReport
from robomech_ros.errors import BadValueError, MissingLimitsError
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.outcomes import Code
from robomech_ros.spatial.arrays import (
    LARGEST,
    LEAST,
    as_choice,
    as_single,
    check_kind,
    real_within,
)
from robomech_ros.typing import Array, ArrayLike, BoolArray
from robomech_ros.walking.gait_timing import SPEED_PART, fastest_twist, suitable_cycle, sway_cycle
from robomech_ros.walking.gaits import GAITS
from robomech_ros.walking.robot import LeggedRobot
from robomech_ros.walking.stride import Stride, TrunkPoseCheck, stride_of
from robomech_ros.walking.trunk_path import TrunkPath

_ADVANCE, _POSSIBLE = direct(gait_step.advance), direct(gait_step.possible_part)
_SUSTAINED = direct(gait_step.sustained_part)
_STILL = np.zeros(3)
# Ratio to the velocity limit that a slowed period aims at.
_BELOW = 0.999
_TRIES = 8
# Parts of the rest of a way of the trunk at which its poses are checked.
_ON_THE_WAY = np.linspace(0.0, 1.0, 9)[1:]
# Periods that a swing takes at least.
_LEAST_SWING = 8


@dataclass(frozen=True, slots=True, eq=False)
class WalkUpdate:
    """Result of one period of walking.

    Attributes
    ----------
    q, rates : ndarray, shape (3 k,)
        All joints, and their mean rates over the period (rad or m, and s).
    contacts : ndarray of bool, shape (k,)
        Which feet stand.
    feet : ndarray, shape (k, 3)
        Over the ground (m).
    base : ndarray, shape (3,)
        x, y (m) and yaw (rad) over the ground of the frame that moves with the command.
    trunk : ndarray, shape (4, 4)
        Pose of the trunk over the ground (m).
    twist : ndarray, shape (3,)
        [w, vx, vy] of that frame in its own axes (rad/s, m/s).
    margin : float
        Static stability margin (m).
    part : float
        Part of the commanded twist that feet and joints allow, 1 where nothing limits it.
    walking : bool
        Whether feet move; if not, all are down.
    """

    q: Array
    rates: Array
    contacts: BoolArray
    feet: Array
    base: Array
    trunk: Array
    twist: Array
    margin: float
    part: float
    walking: bool


class Walker:
    """A legged robot that follows twists, period by period.

    Feet that stand do not move.  Each may stand within a circle around its place below the trunk,
    small enough for its leg to reach all of it and for the margin to keep its bound in whatever
    pattern feet stand; a command that would lead a foot out of it is scaled, which keeps its
    curvature, and a period in which a joint would be too fast is slowed down as a whole.

    Parameters
    ----------
    robot : LeggedRobot
        With velocity limits of all joints.
    gait : str, optional
        One of :data:`GAITS`; default tripod for six legs, crawl for four.
    period : float, optional
        Time between updates (s).
    cycle : float, optional
        Duration of a cycle of the gait (s), at least eight periods a swing, and so long that a
        trunk that sways does not tip the robot by its acceleration.  Default the shortest such one,
        for each gait, in which joints keep below 60 % of their velocity limits at the longest
        stride, and feet are in the air for 0.3 s or more.
    lift : float, optional
        How high feet are lifted (m).
    bound : float, optional
        Margin that is kept (m); default 0.01, and of the trot, which stands on lines, -0.04.
    timeout : float, optional
        Time without a command (s) after which the robot stops, all feet down.
    acceleration : sequence of float, optional
        Bounds of the rates of [w, vx, vy] (rad/s^2, m/s^2), on the straight way from one twist to
        another, also where feet or a new command have the robot brake.
    speed : float, optional
        Part of the joints' velocity limits that is used, up to 1.

    Raises
    ------
    MissingLimitsError, BadValueError
        Not such values, a gait for other robots, or one that keeps no such margin.

    Examples
    --------
    >>> from robomech_ros.walking import Walker, load_legged
    >>> walker = Walker(load_legged("phantomx"))
    >>> walker.command([0.0, 0.05, 0.0])
    >>> update = walker.update()
    >>> update.walking, int(update.contacts.sum()) >= 3
    (True, True)
    """

    def __init__(
        self,
        robot: LeggedRobot,
        *,
        gait: str | None = None,
        period: float = 0.005,
        cycle: float | None = None,
        lift: float = 0.03,
        bound: float | None = None,
        timeout: float = 0.5,
        acceleration: ArrayLike = (1.0, 0.5, 0.5),
        speed: float = 1.0,
    ) -> None:
        check_kind("robot", robot, LeggedRobot, "a LeggedRobot")
        missing = np.array(robot.joint_names)[~np.isfinite(robot.velocity)].tolist()
        if missing:
            raise MissingLimitsError("velocity", missing)
        self.robot = robot
        self.period = _positive("period", period)
        self._cycle = None if cycle is None else _positive("cycle", cycle)
        self.lift = _positive("lift", lift)
        self.timeout = _positive("timeout", timeout)
        self._bound = None if bound is None else finite_number("bound", bound, "m")
        self._acceleration = as_single("acceleration", acceleration, (3,))
        if self._acceleration.min() <= 0.0:
            raise BadValueError("acceleration", self._acceleration.tolist(), "three above 0")
        self._speed = _positive("speed", speed)
        if self._speed > 1.0:
            raise BadValueError("speed", speed, "at most 1, all of the limits")
        bounds = (robot.lower, robot.upper, self._speed * robot.velocity)
        rows = [one.reshape(-1, 3) for one in bounds]
        self._limits = np.ascontiguousarray(np.stack(rows, axis=1))
        chosen = gait if gait is not None else ("crawl" if len(robot.legs) == 4 else "tripod")
        self._stride = self._strides(chosen)
        self._waiting: Stride | None = None
        self.stand()

    def stand(self, place: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Begin anew at a place, standing at home with all feet down.

        Parameters
        ----------
        place : array_like, shape (3,), optional
            x, y (m) and yaw (rad) over the ground.
        """
        where = as_single("place", place, (3,))
        if self._waiting is not None:
            self._stride, self._waiting = self._waiting, None
        self._pose, self._way = self._stride.level.copy(), TrunkPath(np.zeros(6))
        self._command, self._velocity = np.zeros(3), np.zeros(3)
        self._age, self._walking = np.inf, False
        body, feet = np.zeros(15), np.zeros((len(self.robot.legs), 8))
        body[:3] = where
        c, s = np.cos(where[2]), np.sin(where[2])
        feet[:, :2] = where[:2] + self._stride.geometry[:, :2] @ np.array([[c, s], [-s, c]])
        self._state = State(body, feet, self.robot.home.reshape(-1, 3).copy())
        self._margin, self._part = 0.0, 1.0
        self._step(_STILL, self._pose, self.period)

    def _strides(self, gait: str) -> Stride:
        known = GAITS[as_choice("gait", gait, tuple(GAITS))]
        stride = stride_of(self.robot, known, self.lift, self._bound)
        cycle = self._cycle
        if cycle is None:
            part = min(1.0, SPEED_PART / self._speed)
            cycle = suitable_cycle(self.robot, stride, self._limits, part)
        swing, sway = _LEAST_SWING * self.period / float(1 - known.duty), sway_cycle(stride)
        if cycle < max(swing, sway):
            least = f"{math.ceil(1e3 * max(swing, sway)) / 1e3:g} s or more"
            why = ": a trunk that sways faster may tip the robot" if sway > swing else ""
            raise BadValueError(f"cycle of the gait '{gait}'", cycle, least + why)
        stride.settings[0] = cycle
        return stride

    @property
    def cycle(self) -> float:
        """Duration of a cycle of the gait (s)."""
        return float(self._stride.settings[0])

    @property
    def fastest(self) -> Array:
        """The greatest w, vx and vy (rad/s, m/s), each by itself, that feet can follow."""
        return fastest_twist(self._stride)

    @property
    def gait(self) -> str:
        """Name of the gait."""
        return self._stride.gait.name

    @property
    def bound(self) -> float:
        """The margin (m) that is kept."""
        return self._stride.bound

    @property
    def radius(self) -> float:
        """Allowed distance of a foot from its position (m)."""
        return float(self._stride.settings[3])

    def command(self, twist: ArrayLike) -> None:
        """Command a twist, until the next one or the time-out.

        Parameters
        ----------
        twist : array_like, shape (3,)
            [w, vx, vy] of the trunk in its own axes (rad/s, m/s).
        """
        self._command = as_single("twist", twist, (3,)).copy()
        self._age = 0.0

    def command_gait(self, gait: str) -> None:
        """Change the gait, as soon as the robot stands; until then it stops.

        Raises
        ------
        BadValueError
            No gait of this name, or none for this robot.
        """
        stride = self._strides(gait)
        answer = stride.possible(self.robot, [self._way.offset, self._way.goal])
        if answer.status != Code.NONE:
            raise BadValueError("gait", gait, f"one that suits the pose: {answer.reason}")
        self._waiting = stride

    def command_pose(self, pose: ArrayLike, duration: float = 1.0) -> TrunkPoseCheck:
        """Move the trunk over the feet, if that neither tips the robot nor overstretches a leg.

        On its way to another pose it turns to this one without a stop.

        Parameters
        ----------
        pose : array_like, shape (6,)
            x, y, z (m) and roll, pitch, yaw (rad) beside the level pose at nominal height.
        duration : float, optional
            Time to get there (s); longer where the acceleration would tip the robot.

        Returns
        -------
        TrunkPoseCheck
            NONE, else why it is refused, with leg and joint; nothing moves then.
        """
        target = as_single("pose", pose, (6,))
        time = _positive("duration", duration)
        if np.array_equal(target, self._way.goal):
            # It is on its way there already, or there.
            return TrunkPoseCheck(Code.NONE)
        stride = self._stride
        way = self._way.to(target.copy(), max(time, stride.quickest(self._way.end, target)))
        offsets = [*(way.ahead(part * way.rest) for part in _ON_THE_WAY), way.goal]
        answer = stride.possible(self.robot, offsets)
        if answer.status == Code.NONE and self._waiting is not None:
            answer = self._waiting.possible(self.robot, offsets)
        if answer.status == Code.NONE:
            self._way = way
        return answer

    def moment(self) -> Walker:
        """Keep this moment of the walk, to go on from it later by ``resume``."""
        return copy(self)

    def resume(self, moment: Walker) -> None:
        """Go back to a moment of this walk, from where it goes on without a command.

        Raises
        ------
        BadValueError
            It is not one of this robot.
        """
        if not isinstance(moment, Walker) or moment.robot is not self.robot:
            raise BadValueError("moment", moment, "what `moment` of this walker gave")
        self.__dict__.update(moment.__dict__)
        self._command = np.zeros(3)

    def update(self) -> WalkUpdate:
        """Go on by one period."""
        self._age += self.period
        wanted = self._command
        if self._age > self.timeout or self._waiting is not None:
            wanted = _STILL
        pattern = self._stride.pattern
        sustained = _SUSTAINED(pattern, wanted)
        # The last twist keeps all feet in their circles, this one, too, and so do those between:
        # what has come of a command never jumps.
        sustained *= _POSSIBLE(pattern, self._state, sustained * wanted, self.period, True)
        velocity = self._towards(sustained * wanted)
        moves = bool(velocity.any())
        if moves and not self._walking:
            body = self._state.body.copy()
            body[3], body[10] = self._stride.start(body[3]), -1.0
            self._walking, self._state = True, self._state._replace(body=body)
        possible = _POSSIBLE(pattern, self._state, velocity, self.period, False) if moves else 1.0
        self._velocity = possible * velocity
        self._part = sustained * possible * self._go(self._velocity)
        if self._walking and not moves and self._at_rest():
            self._walking = False
        if not self._walking and self._waiting is not None:
            self._stride, self._waiting = self._waiting, None
        body, feet, q = self._state
        return WalkUpdate(
            q=q.ravel(),
            rates=self._rates.ravel(),
            contacts=feet[:, 7] == 0.0,
            feet=feet[:, :3],
            base=body[:3],
            trunk=self._trunk,
            twist=self._twist,
            margin=self._margin,
            part=self._part,
            walking=self._walking,
        )

    def _towards(self, twist: Array) -> Array:
        """Return the twist after a period on the straight way to another one."""
        change = twist - self._velocity
        most = self._acceleration * self.period
        over = float((np.abs(change) / most).max())
        return twist if over <= 1.0 else self._velocity + change / over

    def _go(self, twist: Array) -> float:
        """Make one period, slowed down where a joint would be too fast; give the part of it."""
        part = 1.0
        for _ in range(_TRIES):
            time = part * self.period
            way = self._way.after(time)
            pose = self._pose if self._way.over else self._stride.pose(way.offset)
            state = self._step(twist, pose, time)
            if state <= 1.0:
                break
            part *= _BELOW / state
        else:
            part, way, pose = 0.0, self._way, self._pose
            self._step(_STILL, pose, 0.0)
        self._way, self._pose = way, pose
        self._state, self._twist = self._next, twist * part
        return part

    def _step(self, twist: Array, pose: Array, time: float) -> float:
        """Compute the next state; give the largest part of a joint's speed, inf out of limits."""
        pattern, state = self._stride.pattern, self._state
        pattern.settings[5] = 1.0 if self._walking else 0.0
        new = State(*(np.empty_like(one) for one in state))
        seen = StepReport(np.empty_like(state.q), np.empty((4, 4)), np.empty(4))
        step = Step(twist, pose, time, self.period)
        lost = _ADVANCE(self.robot.packed, self._limits, pattern, step, state, new, seen)
        self._next, self._rates, self._trunk = new, seen.rates, seen.trunk
        self._margin, self._twist = float(seen.report[0]), twist
        return np.inf if lost >= 0 or seen.report[3] > 1e-9 else float(seen.report[1])

    def _at_rest(self) -> bool:
        """Return whether all feet stand at their places and the trunk does not sway."""
        body, feet, _ = self._state
        if feet[:, 7].any() or body[4] != 0.0 or body[5] != 0.0:
            return False
        c, s = np.cos(body[2]), np.sin(body[2])
        away = (feet[:, :2] - body[:2]) @ np.array([[c, -s], [s, c]])
        return bool(np.abs(away - self._stride.geometry[:, :2]).max() < 1e-6)


def _positive(what: str, value: object) -> float:
    return real_within(what, value, "a number above 0", LEAST, LARGEST)
