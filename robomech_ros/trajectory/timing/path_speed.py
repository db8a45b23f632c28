"""The largest speed along a path within limits, on a grid that refines itself."""

import numpy as np

from robomech_ros._kernels.timing import (
    bounds as time_bounds,
    constraint_rows as time_rows,
    optimal as time_optimal,
    speed_curvature as time_bends,
)
from robomech_ros._kernels.timing.planar_program import ROW_SLACK
from robomech_ros.errors import BadValueError
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.timing.speed_profile import TIMING_MARGIN, PathLimits, SpeedProfile
from robomech_ros.trajectory.tolerances import LIMIT_SLACK, PATH_STEP
from robomech_ros.typing import Array, IntArray

# Cells of the first grid: in a piece of the path, and in a path of few pieces.
_CELLS_IN_PIECE = 16
_FEWEST_CELLS = 64
# Parts of the first and the last cell at which it is divided.
_TO_ENDS = 8.0 ** np.arange(-5.0, 0.0)
# Most cells of all pieces of a very long path, at first and at last.
_MOST_CELLS = 40_000
_MOST_REFINED = 200_000
# Part of the duration that one cell may cost by its length, before it is divided.
_CELL_COST = 1e-4
# The grid is refined at least and at most so many times, and while it gains this part of the time.
_LEAST_PASSES, _MOST_PASSES = 3, 8
_WORTHWHILE = 3e-3
# No cell is shorter than this part of the path.
_SHORTEST = 1e-7
# Duration (s) of a whole path at the speed that bounds what nothing else bounds.
_INSTANT = 1e-9


def fastest(
    path: PiecewisePolynomial, limits: PathLimits, begin: float = 0.0, end: float = 0.0
) -> SpeedProfile:
    """Find the largest speed along a path with continuous first derivative and given end speeds."""
    nodes = _first_grid(path.breaks)
    bends = np.zeros(len(nodes) - 1)
    best: SpeedProfile | None = None
    for done in range(1, _MOST_PASSES + 1):
        profile = _profile(path, limits, nodes, bends, begin, end)
        missed = _missed(profile, begin, end)
        gain = 1.0 if best is None else 1.0 - profile.duration / best.duration
        if best is None or (missed, profile.duration) < (_missed(best, begin, end), best.duration):
            best = profile
        if done >= _LEAST_PASSES and gain < _WORTHWHILE:
            break
        nodes, bends = _refined(profile)
        if len(bends) > _MOST_REFINED:
            break
    assert best is not None
    _check_ends(best, begin, end)
    return best


def _first_grid(breaks: Array) -> Array:
    pieces = len(breaks) - 1
    wanted = max(_CELLS_IN_PIECE, -(-_FEWEST_CELLS // pieces))
    count = max(min(wanted, _MOST_CELLS // pieces), 1)
    parts = np.arange(count) / count
    inner = (breaks[:-1, None] + np.diff(breaks)[:, None] * parts).ravel()
    # Finer towards both ends, where a motion from rest soon comes to other bounds.
    shortest = _SHORTEST * (breaks[-1] - breaks[0])
    first, last = np.diff(breaks)[[0, -1], None] / count * _TO_ENDS
    begin, end = breaks[0] + first[first >= shortest], breaks[-1] - last[last >= shortest][::-1]
    return np.concatenate([inner[:1], begin, inner[1:], end, breaks[-1:]])


def _refined(profile: SpeedProfile) -> tuple[Array, Array]:
    cells = len(profile.spans)
    bends = np.empty(cells)
    given = profile.squares, profile.spans, profile.binding
    time_bends.bends(*given, bends)
    nodes = np.empty(2 * time_bends.PARTS * cells + 1)
    finer = np.empty(2 * time_bends.PARTS * cells)
    shortest = _SHORTEST * (profile.nodes[-1] - profile.nodes[0])
    count = time_bends.refine(*given, profile.nodes, bends, _CELL_COST, shortest, nodes, finer)
    return nodes[: count + 1], finer[:count]


def _profile(
    path: PiecewisePolynomial,
    limits: PathLimits,
    nodes: Array,
    bends: Array,
    begin: float,
    end: float,
) -> SpeedProfile:
    """Find the largest speed on one grid with given bends."""
    spans = np.diff(nodes)
    size, _, joints = path.coefficients.shape
    local = np.empty((len(spans), joints, size))
    time_rows.local_path(path.breaks, path.coefficients, nodes, local)
    bounds = _bounds(limits, nodes, spans, local, bends)
    first, second, rest, owners = _rows(limits, nodes, spans, local, bends)
    rows = first, second, rest, bounds
    ends = _square(begin, local[0, :, 1]), _square(end, _last_rate(local, spans))
    squares, fault = _passes(rows, *ends)
    if fault is not None and end > 0.0:
        squares, fault = _passes(rows, ends[0], -1.0)  # as fast as possible; refused by the caller
    if fault is not None:
        raise _impossible(limits, float(nodes[fault]))
    binding = np.empty(len(spans), np.int64)
    time_optimal.binding_rows(*rows, squares, owners, binding)
    return SpeedProfile(nodes, local, bends, squares, binding)


def _square(speed: float, rate: Array) -> float:
    """Return the wanted square of the speed at an end; any, -1, if the joints rest there anyway."""
    return -1.0 if speed == 0.0 and not rate.any() else speed * speed


def _last_rate(local: Array, spans: Array) -> Array:
    """Return the derivatives of the joints at the path's end, zero if they are rounding."""
    powers = np.arange(1.0, local.shape[2])
    terms = local[-1, :, 1:] * powers * spans[-1] ** (powers - 1.0)
    rate: Array = terms.sum(axis=1)
    rate[np.abs(rate) <= PATH_STEP * np.abs(terms).max(axis=1)] = 0.0
    return rate


def _passes(
    rows: tuple[Array, Array, Array, Array], begin: float, end: float
) -> tuple[Array, int | None]:
    """Find the squares of the speed at the nodes, and the cell that cannot be passed, if any."""
    lowest, highest, squares = np.empty((3, len(rows[3])))
    where = np.zeros(1, np.int64)
    status = time_optimal.speed_profile(*rows, begin, end, lowest, highest, squares, where)
    for wanted, node, coefficients in ((begin, 0, rows[0][0]), (end, -1, rows[1][-1])):
        # The range from which the end can be reached begins at the wanted square except for
        # rounding.
        change = abs(squares[node] - wanted) * np.abs(coefficients).max(initial=0.0)
        if wanted >= 0.0 and change <= ROW_SLACK:
            squares[node] = wanted
    return squares, None if status == time_optimal.DONE else int(where[0])


def _differences(
    profile: SpeedProfile, begin: float, end: float
) -> list[tuple[str, float, float, bool]]:
    """List for both ends the wanted speed, the one that is possible, and whether they agree."""
    last = _last_rate(profile.local, profile.spans)
    found = []
    for which, wanted, square, rate in (
        ("initial", begin, profile.squares[0], profile.local[0, :, 1]),
        ("final", end, profile.squares[-1], last),
    ):
        possible = float(np.sqrt(square))
        free = _square(wanted, rate) < 0.0
        near = free or abs(possible - wanted) <= LIMIT_SLACK * wanted
        found.append((which, wanted, possible, near))
    return found


def _missed(profile: SpeedProfile, begin: float, end: float) -> float:
    """By how much the wanted speeds at the ends are missed; 0 where they are met."""
    return sum(
        0.0 if near else abs(wanted - possible)
        for _, wanted, possible, near in _differences(profile, begin, end)
    )


def _check_ends(profile: SpeedProfile, begin: float, end: float) -> None:
    """Refuse speeds at the ends that the limits do not allow."""
    for which, wanted, possible, near in _differences(profile, begin, end):
        if not near:
            most = "at most" if possible < wanted else "at least"
            expected = f"{most} {possible:.9g}, which the limits allow"
            raise BadValueError(f"{which} path speed", wanted, expected)


def _bounds(limits: PathLimits, nodes: Array, spans: Array, local: Array, bends: Array) -> Array:
    """Bound the squares of the speed at the nodes by the limits of speeds, shape (m + 1,)."""
    bounds = np.full(len(nodes), ((nodes[-1] - nodes[0]) / _INSTANT) ** 2)
    rates = np.empty((*local.shape[:2], local.shape[2] - 1))
    time_bounds.joint_rates(local, spans, limits.velocity_scales, rates)
    time_bounds.speed_bounds(rates, bends, bounds)
    if limits.speeds:
        margin = 1.0 + TIMING_MARGIN
        others = np.stack([speed.powers(nodes) * margin for speed in limits.speeds], axis=1)
        time_bounds.speed_bounds(others, bends, bounds)
    if limits.square is not None:
        np.minimum(bounds, limits.square(nodes), out=bounds)
    return bounds


def _rows(
    limits: PathLimits, nodes: Array, spans: Array, local: Array, bends: Array
) -> tuple[Array, Array, Array, IntArray]:
    """Write all limits of accelerations and torques as rows, and to which quantity each belongs."""
    cells, joints, size = local.shape
    start = joints * size
    others = sum(torques.count for torques in limits.torques)
    first = np.empty((cells, start + 7 * others))
    second = np.empty_like(first)
    rest = np.zeros((cells if others else 1, first.shape[1]))
    owners = np.concatenate(
        [np.repeat(np.arange(joints), size), np.repeat(np.arange(joints, joints + others), 7)]
    )
    time_rows.joint_rows(local, spans, bends, limits.acceleration_scales, first, second)
    if limits.slowdown is not None:
        less = 1.0 / limits.slowdown(0.5 * (nodes[:-1] + nodes[1:]))[:, None]
        first[:, :start] *= less
        second[:, :start] *= less
    for torques in limits.torques:
        margin = 1.0 + TIMING_MARGIN
        a, b, c = (margin * powers for powers in torques.powers(nodes))
        time_rows.other_rows(a, b, c, spans, bends, start, first, second, rest)
        start += 7 * torques.count
    # Without gravity, as on a horizontal plane, nothing drifts: every path can be passed slowly.
    return first, second, rest if rest.any() else rest[:1], owners + 1


def _impossible(limits: PathLimits, where: float) -> BadValueError:
    expected = f"limits that allow a motion; at path coordinate {where:.9g} these allow none"
    if not limits.torques:
        return BadValueError("speed limits", [speed.limit for speed in limits.speeds], expected)
    bounds = [(torques.lower.tolist(), torques.upper.tolist()) for torques in limits.torques]
    return BadValueError("torque limits", bounds, expected)
