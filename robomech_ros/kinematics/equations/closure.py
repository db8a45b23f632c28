"""The fourteen closure equations of a six-revolute arm, and what eliminating two joints leaves.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.2 and 9.3.
Raghavan and Roth, ASME J. Mechanical Design 115 (1993), pp. 502-508.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics.inverse.request.target import as_targets
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import real_number
from robomech_ros.typing import Array, ArrayLike, ComplexArray, IntArray

Numbers = Array | ComplexArray

# Three angles at which a combination of cosine, sine and 1 is known by its values, and what takes
# the values there to its coefficients.
THIRDS: Array = np.array([0.0, 2.0, 4.0]) * np.pi / 3.0
FROM_THIRDS = np.array([2.0 * np.cos(THIRDS), 2.0 * np.sin(THIRDS), np.ones(3)]) / 3.0


@dataclass(frozen=True, eq=False)
class ClosureEquations:
    r"""The closure equations of one pose, and what is left of them without joints 1 and 2.

    With the links L, turns J about z and the target in the place of the last link,

    .. math:: L_2 J_3 L_3 J_4 L_4 J_5 L_5 = J_2^{-1} L_1^{-1} J_1^{-1} L_6^{-1} J_6^{-1}

    The third column l and the fourth column p of both sides do not see joint 6; neither do

    .. math:: p \cdot p, \; p \cdot l, \; p \times l, \; (p \cdot p)\, l - 2 (p \cdot l)\, p

    Written for another ``first`` joint, joints 1 to 6 stand for ``joints`` in their order.

    Parameters
    ----------
    chain : SerialChain
    target : ndarray, shape (4, 4)
        Pose of the tip in the base (m).
    first : int
        The joint that the equations call 1, from 1 to 6.
    size : float
        What lengths are divided by (m): the sum of those of all links and of the target.
    links : ndarray, shape (6, 4, 4)
        L_1 .. L_6.
    left : ndarray, shape (14, 3, 3, 3)
        Coefficients of the products of (cos, sin, 1) of joints 3, 4 and 5, in the order p, l,
        p x l, (p.p) l - 2 (p.l) p, p.p, p.l.
    right : ndarray, shape (14, 9)
        The same of joints 1 and 2, the constant last.
    free : ndarray, shape (6, 3, 3, 3)
        Combinations of both sides in which joints 1 and 2 do not appear: they vanish.
    """

    chain: SerialChain
    target: Array
    first: int
    size: float
    links: Array
    left: Array
    right: Array
    free: Array

    @property
    def joints(self) -> IntArray:
        """Indices in the chain, from 0, of what the equations call joints 1 to 6; shape (6,)."""
        return (np.arange(6) + self.first - 1) % 6

    def residual(self, q: ArrayLike) -> Numbers:
        """Return left minus right sides at a posture.

        Parameters
        ----------
        q : array_like, shape (6,)
            The chain's joint angles (rad), real or complex.

        Returns
        -------
        ndarray, shape (14,)
            Lengths in parts of ``size``.
        """
        angles = as_angles("q", q)
        if angles.shape != (6,):
            raise WrongSizeError("q", angles.shape, "(6,)")
        one, two, three, four, five = (circle(x) for x in angles[self.joints][:5])
        left = np.einsum("eijk,i,j,k->e", self.left, three, four, five)
        right = self.right @ np.outer(one, two).ravel()
        return left - right

    def six_by_nine(self, q3: ArrayLike) -> Numbers:
        """Return the 6 x 9 matrix of the equations in joints 4 and 5.

        Parameters
        ----------
        q3 : array_like, shape (...)
            Joint 3 (rad), real or complex.

        Returns
        -------
        ndarray, shape (..., 6, 9)
            E with ``E m = 0`` for the products m of (cos, sin, 1) of joint 4 and of joint 5.
        """
        E = np.einsum("eijk,i...->...ejk", self.free, circle(as_angles("q3", q3)))
        return E.reshape(*E.shape[:-3], 6, 9)

    def three_columns(self, q4: ArrayLike, q5: ArrayLike) -> Numbers:
        """Return the matrix G of the bivariate approach (section 9.4).

        Parameters
        ----------
        q4, q5 : array_like, shape (...)
            Joints 4 and 5 (rad), real or complex.

        Returns
        -------
        ndarray, shape (..., 6, 3)
            With ``G (cos q_3, sin q_3, 1)^T = 0``.
        """
        four, five = as_angles("q4", q4), as_angles("q5", q5)
        try:
            four, five = np.broadcast_arrays(four, five)
        except ValueError:
            raise WrongSizeError(
                "q4 and q5", (four.shape, five.shape), "shapes that fit together"
            ) from None
        return np.einsum("eijk,j...,k...->...ei", self.free, circle(four), circle(five))


def closure_equations(chain: SerialChain, T: ArrayLike, *, first: int = 1) -> ClosureEquations:
    """Write down the closure equations of an arm of six revolute joints at a pose.

    Each side is linear in cosine and sine of each of its joints, so that its values at three angles
    of each give the coefficients exactly.

    Parameters
    ----------
    chain : SerialChain
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).
    first : int, optional
        The joint that the equations call 1: the loop of arm and target can be cut at any.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.2.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.kinematics.equations import closure_equations
    >>> from robomech_ros.robots import load_robot
    >>> arm, q = load_robot("diestro"), [0.3, 1.2, -1.4, 1.1, -2.0, 0.7]
    >>> equations = closure_equations(arm, forward_kinematics(arm, q))
    >>> bool(np.abs(equations.residual(q)).max() < 1e-14)
    True
    >>> equations.six_by_nine(q[2]).shape
    (6, 9)
    """
    check_chain(chain)
    if chain.n != 6 or chain.types.any():
        raise BadValueError("chain", chain.name, "an arm of six revolute joints")
    target = as_targets(T)[0]
    expected = "a joint from 1 to 6"
    number = real_number("first", first, expected)
    if number not in range(1, 7):
        raise BadValueError("first", first, expected)
    start = int(number) - 1
    links, size = _loop(chain, target)
    links = np.roll(links, -start, axis=0)
    q = THIRDS
    left = links[1] @ _turns(q, 0, 3) @ links[2] @ _turns(q, 1, 3) @ links[3] @ _turns(q, 2, 3)
    left = _quantities(left @ links[4])
    left = np.einsum("ai,bj,ck,ijke->eabc", *(FROM_THIRDS,) * 3, left)
    right = _turns(-q, 1, 2) @ np.linalg.inv(links[0]) @ _turns(-q, 0, 2) @ np.linalg.inv(links[5])
    right = np.einsum("ai,bj,ije->eab", *(FROM_THIRDS,) * 2, _quantities(right)).reshape(14, 9)
    moved = left.copy()
    moved[:, 2, 2, 2] -= right[:, 8]
    # Combinations of rows in which the eight products of joints 1 and 2 cancel.
    combinations = np.linalg.svd(right[:, :8])[0][:, 8:].T
    free = np.einsum("er,rijk->eijk", combinations, moved)
    return ClosureEquations(chain, target, start + 1, size, links, left, right, free)


def as_angles(what: str, value: ArrayLike) -> Numbers:
    """Return angles (rad), real or complex, as an array of any shape; messages name them."""
    try:
        angles = np.asarray(value)
    except (TypeError, ValueError):
        raise BadValueError(what, value, "angles, real or complex") from None
    if angles.dtype.kind not in "fiuc":
        raise BadValueError(what, value, "angles, real or complex")
    if not np.isfinite(angles).all():
        raise NonFiniteError(what, angles if angles.ndim else angles.item())
    return angles


def circle(angle: ArrayLike) -> Numbers:
    """Return (cos, sin, 1) of angles (...) in rad, real or complex, shape (3, ...)."""
    angle = np.asarray(angle)
    return np.array([np.cos(angle), np.sin(angle), np.ones_like(np.cos(angle))])


def turn_about_z(angle: ArrayLike) -> Numbers:
    """Return the poses (..., 4, 4) of turns by angles (...) in rad, real or complex."""
    c, s, one = circle(angle)
    pose = np.zeros((*c.shape, 4, 4), dtype=c.dtype)
    pose[..., 0, 0], pose[..., 0, 1] = c, -s
    pose[..., 1, 0], pose[..., 1, 1] = s, c
    pose[..., 2, 2] = pose[..., 3, 3] = one
    return pose


def _turns(angles: Array, axis: int, axes: int) -> Numbers:
    """Put turns along one of so many axes of a grid."""
    shape = [1] * axes
    shape[axis] = len(angles)
    return turn_about_z(angles.reshape(shape))


def _loop(chain: SerialChain, target: Array) -> tuple[Array, float]:
    """Return the links between the joints, the target between joints 6 and 1, and their size."""
    C = chain.transforms
    links = np.concatenate((C[1:6], (C[6] @ np.linalg.inv(target) @ C[0])[None]))
    size = float(np.linalg.norm(links[:, :3, 3], axis=1).sum()) or 1.0
    links[:, :3, 3] /= size
    return links, size


def _quantities(pose: Numbers) -> Numbers:
    """Return p, l, p x l, (p.p) l - 2 (p.l) p, p.p and p.l, shape (..., 14)."""
    l, p = pose[..., :3, 2], pose[..., :3, 3]  # noqa: E741
    square, along = (np.sum(p * x, axis=-1, keepdims=True) for x in (p, l))
    parts = (p, l, np.cross(p, l), square * l - 2.0 * along * p, square, along)
    return np.concatenate(parts, axis=-1)
