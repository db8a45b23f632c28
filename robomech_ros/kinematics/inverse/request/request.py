"""Checked request for inverse kinematics."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.inverse import short_layout
from robomech_ros._kernels.inverse.ranking import INSIDE, first_outside
from robomech_ros._kernels.tolerances import ORIENTATION_TOLERANCE, POSITION_TOLERANCE
from robomech_ros.errors import (
    BadValueError,
    NonFiniteError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.kinematics.inverse.request.task import FULL_TASK, Task
from robomech_ros.kinematics.joint_values import as_joint_values, as_posture, raise_not_finite
from robomech_ros.kinematics.mobility import arm_size, moves_in_all_directions
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.entry_checks import whole_number
from robomech_ros.spatial.arrays import as_flag, listed, real_number
from robomech_ros.typing import Array, ArrayLike

# A seed this far (rad, m) outside the position limits still counts as on the limit: encoders and
# text files carry about this resolution.
SEED_SLACK = 1e-6


METRICS = {"linf": 0, "l2": 1}

# For arrays that are known to be float64, contiguous and of one length.
_first_outside = direct(first_outside)


class Request(NamedTuple):
    """A checked request; the fields are those of :func:`inverse_kinematics`.

    ``seeded`` tells whether the caller has given the seed.
    """

    seed: Array
    seeded: bool
    respect_limits: bool
    include_windings: bool
    metric: int
    max_solutions: int | None
    task: Task
    position_tolerance: float
    orientation_tolerance: float
    timeout: float | None


@lru_cache(maxsize=256)
def default_tolerances(chain: SerialChain, task: Task) -> tuple[float, float]:
    """Return the errors (m, rad) that a task allows: larger if the arm cannot take all poses."""
    whole = task == FULL_TASK and not moves_in_all_directions(chain, arm_size(chain))
    if chain.n < sum(task) or whole:
        return short_layout.POSITION_TOLERANCE, short_layout.ORIENTATION_TOLERANCE
    return POSITION_TOLERANCE, ORIENTATION_TOLERANCE


def is_loose(chain: SerialChain, request: Request) -> bool:
    """Return True if a request allows larger errors than the defaults for the full pose."""
    position, orientation = default_tolerances(chain, FULL_TASK)
    return request.position_tolerance > position or request.orientation_tolerance > orientation


def as_request(
    chain: SerialChain,
    seed: ArrayLike | None = None,
    respect_limits: bool = True,
    include_windings: bool = False,
    metric: str = "linf",
    max_solutions: int | None = None,
) -> Request:
    """Check a request for the full pose; the parameters are those of :func:`inverse_kinematics`."""
    options = (chain, respect_limits, include_windings, metric, max_solutions)
    try:
        usual = _usual(*options)
    except TypeError:  # one cannot be the key of a cache
        usual = _usual.__wrapped__(*options)
    if seed is None:
        return usual
    return Request._make((as_seed(chain, seed, usual.respect_limits), True, *usual[2:]))


def with_task(
    chain: SerialChain,
    request: Request,
    task_mask: Sequence[bool] | None,
    position_tolerance: float | None,
    orientation_tolerance: float | None,
    timeout: float | None,
) -> Request:
    """Check the other options of :func:`inverse_kinematics` and add them to a request."""
    task = _as_task(task_mask)
    position, orientation = default_tolerances(chain, task)
    return request._replace(
        task=task,
        position_tolerance=as_tolerance("position_tolerance", position_tolerance, position),
        orientation_tolerance=as_tolerance(
            "orientation_tolerance", orientation_tolerance, orientation
        ),
        timeout=None if timeout is None else _positive("timeout", timeout),
    )


@lru_cache(maxsize=256, typed=True)
def _usual(
    chain: SerialChain,
    respect_limits: bool,
    include_windings: bool,
    metric: str,
    max_solutions: int | None,
) -> Request:
    """Check a request for the full pose from mid-range, with the default tolerances."""
    respect_limits = as_flag("respect_limits", respect_limits)
    seed = as_seed(chain, None, respect_limits)
    position, orientation = default_tolerances(chain, FULL_TASK)
    return Request(
        seed=seed,
        seeded=False,
        respect_limits=respect_limits,
        include_windings=as_flag("include_windings", include_windings),
        metric=as_metric(metric),
        max_solutions=as_cap(max_solutions),
        task=FULL_TASK,
        position_tolerance=position,
        orientation_tolerance=orientation,
        timeout=None,
    )


def as_seed(chain: SerialChain, seed: ArrayLike | None, respect_limits: bool) -> Array:
    """Check a seed (n,), None for mid-range; SeedOutsideLimitsError where limits are respected."""
    if seed is None and isinstance(chain, SerialChain):
        return chain.midrange()
    q = as_joint_values(chain, seed, "seed")
    if q.ndim != 1:
        raise WrongSizeError("seed", q.shape, f"({chain.n},)")
    if not q.flags.writeable:
        q = q.copy()  # as the kernels want it
    if _first_outside(*_seeds(chain), q, 0.0) == INSIDE:
        return q
    i = _first_outside(chain.lower, chain.upper, q, SEED_SLACK)
    if i != INSIDE:
        if not np.isfinite(q).all():
            raise_not_finite(chain, q, "seed")
        if respect_limits:
            raise SeedOutsideLimitsError(
                chain.joint_names[i], q[i], chain.lower[i], chain.upper[i], unit=chain.units[i]
            )
    return as_posture(chain, q, "seed")


@lru_cache(maxsize=128)
def _seeds(chain: SerialChain) -> tuple[Array, Array]:
    """Return the least and the greatest seed that every request allows."""
    low = np.maximum(chain.lower - SEED_SLACK, -chain.largest)
    return low, np.minimum(chain.upper + SEED_SLACK, chain.largest)


def as_metric(metric: str) -> int:
    """Return the number of a metric in the kernels."""
    number = METRICS.get(metric) if isinstance(metric, str) else None
    if number is None:
        raise BadValueError("metric", metric, " or ".join(repr(name) for name in METRICS))
    return number


def _as_task(mask: Sequence[bool] | None) -> Task:
    """Check a task mask; None and all False are the full pose."""
    if mask is None:
        return FULL_TASK
    given = listed("task_mask", mask, "six of True or False: x, y, z, rx, ry, rz")
    if len(given) != 6:
        raise WrongSizeError("task_mask", len(given), "6: x, y, z, rx, ry, rz")
    x, y, z, rx, ry, rz = entries = [as_flag(f"task_mask[{i}]", one) for i, one in enumerate(given)]
    return (x, y, z, rx, ry, rz) if any(entries) else FULL_TASK


def as_tolerance(what: str, value: float | None, default: float) -> float:
    """Check a tolerance; None is the default."""
    return default if value is None else _positive(what, value)


def as_cap(max_solutions: int | None) -> int | None:
    """Check a cap on the number of solutions."""
    if max_solutions is None:
        return None
    expected = "a whole number of at least 1"
    return whole_number("max_solutions", max_solutions, 1, math.inf, expected)


def _positive(what: str, value: float) -> float:
    number = real_number(what, value, "a positive number")
    if math.isnan(number):
        raise NonFiniteError(what, number)
    if number <= 0.0:
        raise BadValueError(what, number, "a positive number")
    return number
