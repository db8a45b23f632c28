"""Postures from which a twist leads out of a singularity.

In a singular posture the joints can move in ways n that do not move the tip at first; a way of
length s moves it by ``s^2 / 2 u . J'(n) n`` along a lost direction u.  Where that is in the
proportions of what the twist needs along each of them, the tip goes along with the twist: a
stretched elbow bends, and the tip comes inwards.  Where no such motion moves the tip, as for a
wrist, another one gives back what is lost.  The posture next to the singular one, in that way, is
regular, and from there the twist leads on.
"""

import math
from typing import NamedTuple

import numpy as np

from robomech_ros.servo.poses import moved_pose
from robomech_ros.servo.twist_resolver import SINGULAR, TwistResolver
from robomech_ros.typing import Array

# How far beside a singular posture a way begins (rad or m).
_BESIDE = 3e-4
# How far along such a motion it is looked for the line of the twist, where joints turn much more
# than the tip moves (rad or m), and how near the tip must come to that (m or rad).
_AHEAD, _CLOSE = 0.03, 1e-6
# A motion that the tip does not feel is preferred if it gives back this part of what another does.
_NOTICED = 0.1
# A part of a twist below this is rounding; one up to this may be wanted along a singularity.
_SOMETHING, _LITTLE = 1e-6, 1e-2
# Newton's steps for motions that move the tip along with the twist, and what they may be off.
_STEPS, _FOUND = 8, 1e-6


class Start(NamedTuple):
    """A posture (n,), rad or m, from where a way for a twist begins.

    One that is ``outwards`` counts, from beyond the hard stop, only if it leads away from the
    singularity at once.
    """

    q: Array
    outwards: bool = True


def departures(resolver: TwistResolver, q: Array, twist: Array) -> list[Start]:
    """Return the postures from which a twist may lead out of a singularity, the best first.

    The joints are at q (n,), rad or m, beyond the hard stop; the twist (6,) of the tip is in base
    axes, angular first (rad/s and m/s).
    """
    rank = resolver.rank
    left, values, right = np.linalg.svd(resolver.jacobian(q))
    left, values = left[:, :rank], values[:rank]
    parts = left.T @ resolver.scaled(twist)
    size = math.sqrt(float(parts @ parts))
    near = [q]
    none = values * SINGULAR < values[0]
    if none.any():
        lost, wanted = left[:, none].T, parts[none]
        null = right[np.append(np.flatnonzero(none), np.arange(rank, len(q)))]
        ways = []
        if np.abs(wanted).max() > _SOMETHING * size:
            ways = _folds(resolver, q, lost, wanted, null)
            lost = np.vstack((wanted @ lost, lost))
        found = (_regaining(resolver, q, u, null) for u in lost)
        ways += [way for way in found if way is not None]
        near = _beside(resolver, q, ways)
        ahead = (_ahead(resolver, q, twist, sign * way) for way in null[:2] for sign in (1.0, -1.0))
        near += [p for p in ahead if p is not None and _inside(resolver, p)]
    least = parts[values * resolver.stop_at < values[0]]
    if least @ least > (_LITTLE * size) ** 2:
        return [Start(p) for p in near]
    return [Start(p) for p in near] + [Start(p, False) for p in (*near, q)]


def _folds(
    resolver: TwistResolver, q: Array, lost: Array, wanted: Array, null: Array
) -> list[Array]:
    """Find motions of those of null (k, n) that move the tip along lost directions (r, 6)."""
    changes = [resolver.change(q, way) for way in null]
    bends = np.array([[[u @ a @ v for v in null] for a in changes] for u in lost])
    bends = 0.5 * (bends + bends.transpose(0, 2, 1))
    wanted = wanted / math.sqrt(float(wanted @ wanted))
    amounts, ways = np.linalg.eigh(np.tensordot(wanted, bends, 1))
    if amounts[-1] <= _SOMETHING:
        return []
    best, other = ways[:, -1], ways[:, max(len(ways) - 2, 0)]
    found: list[Array] = []
    for share in (0.0, 1.0, -1.0) if len(lost) > 1 else (0.0,):
        w = (best + share * other) / math.sqrt(amounts[-1])
        for _ in range(_STEPS):
            rows = bends @ w
            w = w + np.linalg.lstsq(2.0 * rows, wanted - rows @ w, rcond=1e-9)[0]
        if np.abs(bends @ w @ w - wanted).max() < _FOUND:
            found.append(w @ null)
    return found


def _regaining(resolver: TwistResolver, q: Array, u: Array, null: Array) -> Array | None:
    """Return the change of posture that gives most of u back, to where the joints have room.

    It is one that the tip does not feel, of those of null (k, n), if there is one; None if none
    gives anything back.
    """
    changes = np.array([u @ resolver.change(q, e) for e in np.eye(len(q))]) @ null.T
    ways, amounts, _ = np.linalg.svd(changes)
    if amounts[0] < _SOMETHING:
        return None
    way: Array = ways[:, 0]
    still = null.T @ (null @ way)
    if np.linalg.norm(still @ changes) > _NOTICED * np.linalg.norm(way @ changes):
        way = still
    return way if resolver.room(q, way) >= resolver.room(q, -way) else -way


def _beside(resolver: TwistResolver, q: Array, ways: list[Array]) -> list[Array]:
    """Return the postures next to one that are within the limits of the joints."""
    steps = [_BESIDE / math.sqrt(float(way @ way)) * way for way in ways]
    near = [posture for step in steps for posture in (q + step, q - step)]
    return [p for p in near if _inside(resolver, p)]


def _ahead(resolver: TwistResolver, q: Array, twist: Array, way: Array) -> Array | None:
    """Find the posture some way ahead on the line of a twist that begins in a direction (n,)."""
    begun, posture, time = resolver.heading(q, twist).pose, q + _AHEAD * way, 0.0
    for _ in range(_STEPS):
        here = resolver.heading(posture, twist, True)
        off = resolver.off(moved_pose(begun, time * twist), here.pose)
        along = float(way @ here.rates)
        if along == 0.0:
            return None
        change = here.gain @ off
        more = -float(way @ change) / along
        posture, time = posture + change + more * here.rates, time + more
        if np.abs(posture - q).max() > 2.0 * _AHEAD:
            return None
        if np.abs(off).max() < _CLOSE:
            return posture if time > 0.0 else None
    return None


def _inside(resolver: TwistResolver, q: Array) -> bool:
    return bool(((resolver.chain.lower <= q) & (q <= resolver.chain.upper)).all())
