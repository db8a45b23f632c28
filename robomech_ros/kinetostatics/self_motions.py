"""The self-motion of a redundant arm from where it is, followed both ways until a limit.

The parameter is the length of the way in joint space, which goes on smoothly where the arm angle or
a joint that is locked would turn back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.joint_values import as_posture
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial import axial_vector
from robomech_ros.spatial.arrays import real_number
from robomech_ros.typing import Array, ArrayLike

CONDITIONS = 6
# Steps along the way (rad or m), how many at most in each direction, and after how many the
# beginning counts as reached again.
STEP = 0.08
MOST_STEPS = 200
FIRST_STEPS = 4
# Newton's corrections of a step, and their largest residual (rad or m).
CORRECTIONS = 6
EXACT = 1e-10
# Halvings with which a limit is located: 1e-7 of a step.
HALVINGS = 24


@dataclass(frozen=True, eq=False)
class SelfMotionCurve:
    """A way in joint space along which the tip stays.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints, more than six.
    target : ndarray, shape (4, 4)
        ``T_base_tip`` that is kept (m).
    length : ndarray, shape (m,)
        Increasing, 0 at the posture that it was followed from (rad or m).
    q : ndarray, shape (m, n)
        Postures inside the limits (rad or m).
    ends : tuple of two str
        Why it ends there: the joint at its limit, or that it closes.
    """

    chain: SerialChain
    target: Array
    length: Array
    q: Array
    ends: tuple[str, str]

    @property
    def low(self) -> float:
        """Low end (rad or m), at most 0."""
        return float(self.length[0])

    @property
    def high(self) -> float:
        """High end (rad or m), at least 0."""
        return float(self.length[-1])

    def at(self, length: float) -> Array:
        """Return the posture (n,) at a length (rad or m), or at the end that is nearer to it."""
        length = real_number("length", length, "a number, rad or m")
        if np.isnan(length):
            raise BadValueError("length", length, "a number, rad or m")
        rows = [np.interp(length, self.length, column) for column in self.q.T]
        exact = _corrected(self.chain, self.target, np.array(rows))
        nearest: Array = self.q[int(np.abs(self.length - length).argmin())]
        posture = nearest if exact is None else exact
        return np.clip(posture, self.chain.lower, self.chain.upper)


def self_motion_curve(chain: SerialChain, q: ArrayLike) -> SelfMotionCurve | None:
    """Follow the self-motion of an arm from a posture, both ways until a limit.

    Of several directions in which the tip stays, as of an arm of eight joints, one is followed.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (n,)
        Inside the limits (rad or m).

    Returns
    -------
    SelfMotionCurve or None
        None of an arm of six joints or fewer.

    Raises
    ------
    BadValueError
        q is not n finite numbers, or outside the limits.

    See Also
    --------
    robomech_ros.kinematics.self_motion : all of it, by the arm angle or a joint that is locked.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.kinetostatics import self_motion_curve
    >>> from robomech_ros.robots import load_robot
    >>> arm = load_robot("iiwa14")
    >>> curve = self_motion_curve(arm, arm.home())
    >>> T = forward_kinematics(arm, [curve.at(0.0), curve.at(0.5)])
    >>> bool(np.allclose(T[0], T[1]))
    True
    """
    q = as_posture(chain, q)
    if chain.n <= CONDITIONS:
        return None
    outside = _outside(chain, q)
    if outside is not None:
        low, high = float(chain.lower[outside]), float(chain.upper[outside])
        what, unit = f"joint '{chain.joint_names[outside]}'", chain.units[outside]
        raise BadValueError(what, float(q[outside]), f"{low:.6g} to {high:.6g} {unit}")
    T = forward_kinematics(chain, q)
    ahead, why_ahead = _followed(chain, T, q, 1.0)
    back, why_back = _followed(chain, T, q, -1.0)
    postures = np.array([*back[::-1], q, *ahead])
    moves = np.linalg.norm(np.diff(postures, axis=0), axis=1)
    length = np.concatenate([[0.0], np.cumsum(moves)])
    return SelfMotionCurve(chain, T, length - length[len(back)], postures, (why_back, why_ahead))


def _followed(chain: SerialChain, T: Array, start: Array, sign: float) -> tuple[list[Array], str]:
    found: list[Array] = []
    q = start
    direction = sign * _null_space(chain, q)[-1]
    for k in range(MOST_STEPS):
        null = _null_space(chain, q)
        direction = null.T @ (null @ direction)
        direction /= np.linalg.norm(direction)
        following = _corrected(chain, T, q + STEP * direction)
        if following is None:
            return found, "it cannot be followed farther"
        outside = _outside(chain, following)
        if outside is not None:
            last = _last_inside(chain, T, q, direction)
            return [*found, last], f"joint '{chain.joint_names[outside]}' is at its limit"
        if k >= FIRST_STEPS and np.linalg.norm(following - start) < STEP:
            return found, "it closes"
        found.append(following)
        q = following
    return found, f"it is not followed farther than {MOST_STEPS} steps"


def _null_space(chain: SerialChain, q: Array) -> Array:
    """Return an orthonormal basis of the joint rates that leave the tip, as rows."""
    _, sizes, rows = np.linalg.svd(jacobian(chain, q))
    rank = int((sizes > RANK * sizes[0]).sum())
    return rows[min(rank, CONDITIONS) :]


def _corrected(chain: SerialChain, T: Array, q: Array) -> Array | None:
    """Bring the tip back to a pose by Newton's method of least norm; None if that fails."""
    for _ in range(CORRECTIONS):
        error = _small_error(T, forward_kinematics(chain, q))
        if np.abs(error).max() < EXACT:
            return q
        q = q + np.linalg.lstsq(jacobian(chain, q), error, rcond=RANK)[0]
    return None


def _small_error(target: Array, actual: Array) -> Array:
    """Measure ``pose_error`` of close poses that need no check; the angle is its sine."""
    turn = axial_vector(target[:3, :3] @ actual[:3, :3].T)
    return np.concatenate((turn, target[:3, 3] - actual[:3, 3]))


def _outside(chain: SerialChain, q: Array) -> int | None:
    beyond = np.maximum(chain.lower - q, q - chain.upper)
    joint = int(beyond.argmax())
    return joint if beyond[joint] > 0.0 else None


def _last_inside(chain: SerialChain, T: Array, q: Array, direction: Array) -> Array:
    low, high, last = 0.0, 1.0, q
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        tried = _corrected(chain, T, q + middle * STEP * direction)
        if tried is None or _outside(chain, tried) is not None:
            high = middle
        else:
            low, last = middle, tried
    return last
