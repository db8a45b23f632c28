"""Joint rates for a twist, slowed down where they lead into a singularity.

With the singular values s, vectors u and v of the Jacobian, its linear rows over the
characteristic length, the part ``c = u . twist`` of a twist needs the rates ``c / s v``.  Below a
least value s0 they are ``c / s0 v``, which is what makes them finite in a singular posture and
still leads out of it; damped least squares would stand there.

How fast such rates change s is ``u . J'(rates) v``, with J' the rate of the Jacobian.  Where they
make it smaller, as at the boundary of the workspace, no scale would carry the motion out: it is
slowed down like a motion towards a wall at s0, and stands there.  Where s becomes smaller for
another reason, as for a wrist that passes its singularity, the motion is slowed down in proportion
to the part of it that is about to be lost, but never stands.  Nothing is slowed down that makes s
larger.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.chain.jacobian_rates import jacobian_rate_one
from robomech_ros._kernels.chain.serial import jacobian_one
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.kinematics.joint_values import raise_not_finite
from robomech_ros.kinetostatics.singularities.generic_rank import generic_rank, scaling_length
from robomech_ros.robots.chain import SerialChain
from robomech_ros.servo.poses import norm, small_motion
from robomech_ros.spatial.arrays import held_rows
from robomech_ros.trajectory.paths.partial_poses import least_turn
from robomech_ros.typing import Array

_jacobian_one = direct(jacobian_one)
_rate_one = direct(jacobian_rate_one)

# From this condition number on a posture counts as singular.
SINGULAR = 1e5
# A rate of s (1/s) that counts as none: along a path on which s is constant rounding decides.
_LEVEL = 1e-4
# A scale below this is a halt: what is left of the motion only creeps.
_HALT = 1e-2
# Singular values below this part of s0 say nothing of the direction in which they grow.
_UNCERTAIN = 1e-3
# Rates below this part of the largest are rounding, which must not touch a joint at its limit.
_NO_RATE = 1e-9
# Postures that show how many components an arm can move.
_POSTURES = 3
# The part of a twist that an arm can carry out must be this much of it.
_SOMETHING = 1e-6


class Resolution(NamedTuple):
    """Joint rates (n,) for a whole twist, before scaling (rad/s or m/s).

    A singularity is approached with the part ``scale`` of it, 0 to 1, at most; the posture is
    ``leaving`` if it is near one that the motion leaves. The condition number is that of the
    Jacobian over the characteristic length. The arm can carry out some part of a twist that is
    ``possible``. ``lost`` (6,) is the twist that the posture allows least, angular first (rad/s and
    m/s), or the part of the given one that it does not allow.
    """

    rates: Array
    scale: float
    leaving: bool
    condition_number: float
    possible: bool
    lost: Array


class Heading(NamedTuple):
    """Joint rates (n,) of a twist at a posture (rad/s or m/s).

    The gain (n, 6) gives joint rates for any twist, angular first, less than it needs beyond the
    hard stop. The condition number is over the characteristic length. The arm can carry out the
    whole of a twist that is ``possible``. The pose (4, 4) is that of the tip in the base (m), and
    ``null`` (k, n) are unit motions of the joints that the tip does not feel, those of a regular
    posture.
    """

    rates: Array
    gain: Array
    condition: float
    possible: bool
    pose: Array
    null: Array


@dataclass(frozen=True, eq=False)
class _Posture:
    """The Jacobian of a posture by its singular values, lengths over the characteristic length."""

    q: Array
    left: Array
    values: Array
    right: Array
    condition: float
    lower: float
    least: float


class TwistResolver:
    """Finds joint rates for twists of one chain, of one joint at least; others are a BadValueError.

    From the condition number ``slow_from`` on motions into a singularity are slowed down, and at
    ``stop_at`` they stand. A singular value may fall at ``approach`` times its distance from where
    it must stop (1/s). Linear motions are divided by a length (m), by default the characteristic
    one. ``rank`` is that of the Jacobian in a regular posture.
    """

    def __init__(
        self,
        chain: SerialChain,
        slow_from: float,
        stop_at: float,
        approach: float,
        length: float | None = None,
    ) -> None:
        self.chain, self._approach = chain, approach
        self.slow_from, self.stop_at = slow_from, stop_at
        self._per_length = 1.0 / scaling_length(chain, length)
        self._scale = np.repeat((1.0, self._per_length), 3)
        self._pose = np.empty((4, 4))
        # Which parts of a twist in axes of the tip are held, angular first; None for all.
        self._held: Array | None = None
        self.rank = self._whole_rank = min(generic_rank(chain), chain.n, 6)

    def hold(self, task_mask: Sequence[bool]) -> None:
        """Hold some components of the tip's pose only, as `Servo.hold` describes."""
        rows = held_rows("task_mask", task_mask)
        self._held = None if len(rows) in (0, 6) else np.isin(np.arange(6), rows).astype(np.float64)
        self.rank = self._whole_rank
        if self._held is not None:
            postures = np.random.default_rng(0).uniform(-1.0, 1.0, (_POSTURES, self.chain.n))
            self.rank = max(int(np.linalg.matrix_rank(self.jacobian(q))) for q in postures)

    @property
    def partial(self) -> bool:
        """True if some components of the pose are free."""
        return self._held is not None

    def held(self, motion: Array, pose: Array) -> Array:
        """Return the part of a twist or small motion that is held in the axes of a pose (4, 4)."""
        return motion if self._held is None else self._projector(pose) @ motion

    def off(self, target: Array, pose: Array) -> Array:
        """Return the small motion from a pose to another, of what is held; angular first."""
        return self.held(small_motion(target, pose), pose)

    def turn_left(self, target: Array, pose: Array) -> Array:
        """Return the rotation vector (rad, base axes) from a pose to another, of what is held."""
        rows = np.arange(6) if self._held is None else np.flatnonzero(self._held)
        turn = least_turn(target[:3, :3], pose[:3, :3], rows)
        return self.held(np.concatenate((turn, np.zeros(3))), target)[:3]

    def _projector(self, pose: Array) -> Array:
        """Return the matrix (6, 6) that keeps of twists in base axes what is held."""
        assert self._held is not None
        R, kept = pose[:3, :3], np.zeros((6, 6))
        kept[:3, :3], kept[3:, 3:] = (R * part @ R.T for part in np.split(self._held, 2))
        return kept

    def scaled(self, twist: Array) -> Array:
        """Return a twist, angular first (rad/s and m/s), its linear part over the length."""
        return self._scale * twist

    def condition_number(self, q: Array) -> float:
        """Return that of a posture (rad or m)."""
        return _condition(np.linalg.svd(self.jacobian(q), compute_uv=False), self.rank)

    def resolve(self, q: Array, twist: Array, velocity: Array) -> Resolution:
        """Find the rates for a twist (6,) of the tip in base axes, angular first (rad/s and m/s).

        The joints are at q (n,), and move with a velocity (n,), rad or m, and per s.
        """
        rank, posture = self.rank, self._posture(q)
        condition, right = posture.condition, posture.right
        scaled = self._scale * self.held(twist, self._pose)
        parts = posture.left.T @ scaled
        size = norm(scaled)
        possible = size == 0.0 or norm(parts) > _SOMETHING * size
        needed = parts / np.maximum(posture.values, posture.least) if possible else np.zeros(rank)
        weak = posture.values < posture.lower
        missed = self._missed(posture, parts)
        if not weak.any() or size == 0.0 or not possible:
            rates = _without_rounding(right[:rank].T @ needed)
            return Resolution(rates, 1.0, False, condition, possible, missed)
        sound, lost = self._split(posture, parts, needed, velocity)
        rates = _without_rounding(sound + lost)
        scale, falling = self._slowed(posture, parts, needed, lost, rates)
        return Resolution(rates, scale, not falling, condition, possible, missed)

    def _posture(self, q: Array) -> _Posture:
        left, values, right = np.linalg.svd(self.jacobian(q))
        rank, most = self.rank, values[0]
        bounds = _condition(values, rank), most / self.slow_from, most / self.stop_at
        return _Posture(q, left[:, :rank], values[:rank], right, *bounds)

    def _missed(self, posture: _Posture, parts: Array) -> Array:
        """Return the part of a twist that the posture does not allow, or what it allows least."""
        none = np.where(posture.values < posture.least, parts, 0.0)
        if norm(none) <= _SOMETHING * norm(parts):
            none[np.argmin(posture.values)] = 1.0
        return posture.left @ none / self._scale

    def heading(self, q: Array, twist: Array, wholly: bool = False) -> Heading:
        """Find the joint rates of a twist that is carried out in full, except for its lost part.

        Unlike the rates of :meth:`resolve`, these are smooth where singular values change their
        sign. With ``wholly`` something is lost in singular postures only, not beyond the hard stop.
        """
        rank, posture = self.rank, self._posture(q)
        left, values, right = posture.left, posture.values, posture.right
        least = values[0] / SINGULAR if wholly else posture.least
        strength = values / np.maximum(values, least) ** 2
        gain = (right[:rank].T * strength) @ left.T * self._scale
        scaled = self._scale * self.held(twist, self._pose)
        missing = norm(scaled - left @ (left.T @ scaled))
        possible = missing <= _SOMETHING * norm(scaled)
        pose, null = self._pose.copy(), right[rank:]
        return Heading(gain @ twist, gain, posture.condition, possible, pose, null)

    def jacobian(self, q: Array) -> Array:
        """Return that of a posture (rad or m), its linear rows over the length (6, n).

        Where components of the pose are free, nothing moves them.
        """
        return self.held(self._whole_jacobian(q), self._pose)

    def _whole_jacobian(self, q: Array) -> Array:
        scaled: Array = np.empty((6, self.chain.n))
        if _jacobian_one(self.chain.packed, q, scaled, self._pose):
            raise_not_finite(self.chain, q)
        scaled[3:] *= self._per_length
        return scaled

    def change(self, q: Array, rates: Array) -> Array:
        """Return the rate of the scaled Jacobian at joint rates."""
        scaled: Array = np.empty((6, self.chain.n))
        if _rate_one(self.chain.packed, q, rates, scaled):
            raise_not_finite(self.chain, rates, "rates")
        scaled[3:] *= self._per_length
        if self._held is None:
            return scaled
        whole = self._whole_jacobian(q)
        kept, x, y, z = self._projector(self._pose), *(whole[:3] @ rates)
        turning = np.kron(np.eye(2), ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
        return kept @ scaled + (turning @ kept - kept @ turning) @ whole

    def _split(
        self, posture: _Posture, parts: Array, needed: Array, velocity: Array
    ) -> tuple[Array, Array]:
        """Return the rates of the safe part of a twist, and of the part about to be lost."""
        rank = len(parts)
        weak = posture.values < posture.lower
        none = posture.values < _UNCERTAIN * posture.least
        sound = posture.right[:rank].T @ np.where(weak, 0.0, needed)
        lost = posture.right[:rank].T @ np.where(weak & ~none, needed, 0.0)
        amount = norm(parts[none])
        if amount <= _SOMETHING * norm(parts):
            return sound, lost
        u = posture.left[:, none] @ parts[none] / amount
        null = np.append(np.flatnonzero(none), np.arange(rank, len(posture.q)))
        way = self._way_out(posture, u, posture.right[null], sound + lost, velocity)
        return sound, lost + amount / posture.least * way

    def _way_out(
        self, posture: _Posture, u: Array, null: Array, rates: Array, velocity: Array
    ) -> Array:
        """Find the motion of the joints, of those that the tip does not feel, that regains u.

        Its direction is that in which other rates lead out, or in which the joints move already,
        or in which they have more room.
        """
        changes = [u @ self.change(posture.q, v) for v in null]
        bends = np.array([[a @ v for v in null] for a in changes])
        way: Array = np.linalg.eigh(0.5 * (bends + bends.T))[1][:, -1] @ null
        along = float(u @ self.change(posture.q, rates) @ way)
        if abs(along) < _LEVEL:
            along = float(velocity @ way)
        if abs(along) < _LEVEL:
            along = self.room(posture.q, way) - self.room(posture.q, -way)
        return way if along >= 0.0 else -way

    def room(self, q: Array, way: Array) -> float:
        """Return how far the joints can go in a direction (rad or m)."""
        bound = np.where(way > 0.0, self.chain.upper, self.chain.lower)
        moved = np.abs(way) > _NO_RATE
        room = np.abs(bound - q)[moved] / np.abs(way)[moved]
        return float(min(np.min(room, initial=math.inf), 1e9))

    def _slowed(
        self, posture: _Posture, parts: Array, needed: Array, lost: Array, rates: Array
    ) -> tuple[float, bool]:
        """Return the scale, and whether the posture comes nearer to a singularity."""
        weak = posture.values < posture.lower
        last = int(np.argmin(posture.values))
        change = self.change(posture.q, rates)
        fall = -float(posture.left[:, last] @ change @ posture.right[last])
        if posture.values[last] < _UNCERTAIN * posture.least:
            # Every way leads out of a singular posture.
            fall = -abs(fall)
        left = max(float(posture.values[last]), posture.least)
        part = norm(parts[weak]) / norm(parts)
        scale = min(1.0, self._approach * left / max(fall * part, 1e-300))
        shares = np.where(weak, parts * needed, 0.0)
        amount = float(shares.sum())
        if amount > _NO_RATE * float(parts @ needed):
            u = posture.left @ np.where(weak, parts, 0.0)
            pull = -float(u @ self.change(posture.q, lost) @ lost) / amount
            # Nothing is a wall that the motion as a whole leads away from.
            pull = min(pull, -float(u @ change @ lost) / amount)
            # No wall is where the joints would have to turn by a radian to get there.
            pull -= posture.least * norm(lost)
            value = float(shares @ posture.values) / amount
            if pull > _LEVEL:
                # The motion takes away from itself what it needs.
                distance = max(value - posture.least, 0.0)
                before_wall = (self._approach * distance + _LEVEL) / pull
                scale = min(scale, before_wall if before_wall > _HALT else 0.0)
        return scale, fall > _LEVEL


def _condition(values: NDArray, rank: int) -> float:
    least = float(values[rank - 1])
    return float(values[0]) / least if least > 1e-12 * float(values[0]) else math.inf


def _without_rounding(rates: Array) -> Array:
    return np.where(np.abs(rates) < _NO_RATE * np.abs(rates).max(), 0.0, rates)
