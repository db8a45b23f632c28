"""Joint rates from the twist of the tip."""

from __future__ import annotations

import functools

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.kinetostatics import rates
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, as_rows, raise_not_finite
from robomech_ros.kinetostatics.decoupled_blocks import wrist_of
from robomech_ros.kinetostatics.indices import as_length
from robomech_ros.kinetostatics.point_jacobians import TIP, as_point, rotation_of
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import all_finite, as_finite, real_number, real_within
from robomech_ros.typing import Array, ArrayLike

_joint_rates = direct(rates.joint_rates)

_LARGEST_DAMPING = 1e9


def joint_rates(
    chain: SerialChain,
    q: ArrayLike,
    twist: ArrayLike,
    *,
    point: ArrayLike = TIP,
    axes: ArrayLike | str | None = None,
    length: float | None = None,
    damping: float = 0.0,
    secondary: ArrayLike | None = None,
) -> Array:
    """Compute the joint rates that move a point of the tip link at a twist.

    No inverse is formed.  With six joints ``J qd = [omega; v]`` is solved: with a spherical wrist
    first the rates of the arm from the velocity of the wrist centre, then those of the wrist from
    what the arm leaves of the angular velocity; else by elimination.  More joints give the rates
    of least norm, fewer those of least error.

    Near a singularity every singular value s of J that is less than `damping` d counts with the
    factor ``s / d^2`` in place of ``1 / s``, as damped least squares with the factor d^2 - s^2
    have it: rates stay below the twist over d, and only motions that are nearly lost are
    weakened.  Without damping a singular posture gives the rates of least norm among those of
    least error.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, one at least.
    q : array_like, shape (n,) or (..., n)
        Joint values (rad or m); a batch runs inside one compiled loop.
    twist : array_like, shape (6,) or (..., 6)
        Angular velocity, then the velocity of the point (rad/s and m/s); one for all of a batch
        or one each.
    point : array_like, shape (3,), optional
        Point of the tip link, in its frame (m), that has the twist; default the tip's origin.
    axes : str or array_like, shape (3, 3), optional
        In what axes the twist is expressed: the name of a link, such as ``chain.tip``, or a
        rotation ``R_base_axes``; default the base.
    length : float, optional
        What linear velocities are divided by where errors and singular values are measured (m),
        from 1e-9 to 1e9, such as the characteristic length; default 1 m.
    damping : float, optional
        The singular value below which motions are weakened, up to 1e9; 0 = none is.
    secondary : array_like, of the shape of q, optional
        Rates that are wished for as far as the tip does not feel them (rad/s or m/s), of use to
        arms with more joints than six.

    Returns
    -------
    ndarray, shape (n,) or (..., n)
        Joint rates (rad/s or m/s).

    Raises
    ------
    UnknownLinkError
        The chain has no link with the name of the axes.

    See Also
    --------
    decoupled_jacobian : the blocks of an arm with a spherical wrist.
    joint_accelerations : one derivative further.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.3.  Chiaverini,
    Siciliano and Egeland, Review of the damped least-squares inverse kinematics, IEEE Trans. on
    Control Systems Technology 2(2), 1994.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import jacobian, joint_rates
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> q = [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]
    >>> rates = joint_rates(puma, q, [0.0, 0.0, 0.0, 0.0, 0.0, 0.1])
    >>> np.round(jacobian(puma, q) @ rates, 6) + 0.0
    array([0. , 0. , 0. , 0. , 0. , 0.1])
    """
    q = as_joint_values(chain, q)
    if not chain.n:
        raise BadValueError("chain", chain.name, "one with a joint")
    rows = as_rows(q)
    twists = _twists(chain, q, twist, axes)
    metres = 1.0 if length is None else as_length(length)
    wished = _none(chain.n) if secondary is None else _secondary(chain, secondary, q)
    arm, wrist, out = as_point(point), wrist_of(chain), np.empty(rows.shape)
    split = wrist is not None and wrist.exact
    centre = arm if wrist is None else wrist.centre
    expected = f"a number from 0 to {_LARGEST_DAMPING:g}"
    given = real_number("damping", damping, expected)
    least = real_within("damping", given, expected, 0.0, _LARGEST_DAMPING)
    if _joint_rates(chain.packed, split, centre, arm, metres, least, rows, twists, wished, out):
        raise_not_finite(chain, q)
    if not all_finite(out):
        largest = float(np.abs(twists).max(initial=0.0))
        raise BadValueError("largest of the twist", largest, "a twist with finite joint rates")
    return out.reshape(q.shape)


@functools.lru_cache(maxsize=64)
def _none(n: int) -> Array:
    return np.empty((0, n))


def _twists(chain: SerialChain, q: Array, twist: ArrayLike, axes: ArrayLike | str | None) -> Array:
    """Return the twists in base axes, one row for each row of q."""
    given, batch = as_finite("twist", twist, (6,)), q.shape[:-1]
    if given.ndim > 1 and given.shape[:-1] != batch:
        raise WrongSizeError("twist", given.shape, f"(6,) or {(*batch, 6)}, as q")
    if axes is not None:
        back = np.swapaxes(rotation_of(chain, q, axes), -1, -2)
        parts = given.reshape(*given.shape[:-1], 2, 3)
        with np.errstate(over="ignore", invalid="ignore"):
            turned = parts @ back
        given = turned.reshape(*turned.shape[:-2], 6)
    if given.ndim > 1 or not batch:
        return np.ascontiguousarray(as_rows(given))
    return np.ascontiguousarray(as_rows(np.broadcast_to(given, (*batch, 6))))


def _secondary(chain: SerialChain, secondary: ArrayLike, q: Array) -> Array:
    wished = as_joint_values(chain, secondary, "secondary")
    if wished.shape != q.shape:
        raise WrongSizeError("secondary", wished.shape, f"{q.shape}, that of q")
    if not np.isfinite(wished).all():
        raise_not_finite(chain, wished, "secondary")
    return as_rows(wished)
