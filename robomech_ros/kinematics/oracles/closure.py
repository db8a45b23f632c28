"""The fourteen closure equations of a six-revolute arm, their coefficients found by fitting.

With ``T_3 T_4 T_5`` on the left and ``T_2^-1 T_1^-1 T T_6^-1`` on the right, the direction l of
axis 6 and a point p on it give p, l, p.p, p.l, p x l and (p.p) l - 2 (p.l) p on both sides.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., chapter 9.
Raghavan and Roth, ASME J. Mechanical Design 115 (1993), pp. 502-508.
"""

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.forward_uncompiled import tip_poses
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.numerics import newton_gauss
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import unpack_chain

__all__ = ["ClosureEquations", "circle", "posture_of"]

Array = NDArray[np.float64]

_POSTURES = 80
ACCEPTED = 1e-10


@dataclass(frozen=True, eq=False)
class ClosureEquations:
    """What is left of the closure equations of one pose when joints 1 and 2 are eliminated.

    Parameters
    ----------
    chain : SerialChain
    target : ndarray, shape (4, 4)
    left : ndarray, shape (14, 3, 3, 3)
        Coefficients of the products of (cos, sin, 1) of joints 3, 4 and 5.
    right : ndarray, shape (14, 9)
        The same of joints 1 and 2, the constant last.
    free : ndarray, shape (6, 3, 3, 3)
        Combinations of ``left`` that vanish.
    """

    chain: SerialChain
    target: Array
    left: Array
    right: Array
    free: Array

    @classmethod
    def of(cls, chain: SerialChain, T: Array) -> "ClosureEquations":
        """Fit the coefficients to random postures of the links on either side.

        Raises
        ------
        BadValueError
            No arm of six revolute joints.
        """
        check_chain(chain)
        if chain.n != 6 or chain.types.any():
            raise BadValueError("chain", chain.name, "an arm of six revolute joints")
        C = unpack_chain(chain.packed)
        rng = np.random.default_rng(0)
        angles = rng.uniform(-np.pi, np.pi, (_POSTURES, 5))
        wrist = np.linalg.inv(C[0]) @ T @ np.linalg.inv(C[6])
        left_rows, right_rows, left_values, right_values = [], [], [], []
        for q1, q2, q3, q4, q5 in angles:
            pose = C[2] @ _turn(q3) @ C[3] @ _turn(q4) @ C[4] @ _turn(q5) @ C[5]
            left_values.append(_quantities(pose))
            left_rows.append(np.einsum("i,j,k", circle(q3), circle(q4), circle(q5)).ravel())
            pose = _turn(-q2) @ np.linalg.inv(C[1]) @ _turn(-q1) @ wrist
            right_values.append(_quantities(pose))
            right_rows.append(np.outer(circle(q1), circle(q2)).ravel())
        left = np.linalg.lstsq(np.array(left_rows), np.array(left_values), rcond=None)[0].T
        right = np.linalg.lstsq(np.array(right_rows), np.array(right_values), rcond=None)[0].T
        left = left.reshape(14, 3, 3, 3)
        moved = left.copy()
        moved[:, 2, 2, 2] -= right[:, 8]
        combinations = np.linalg.svd(right[:, :8])[0][:, 8:].T
        free = np.einsum("er,rijk->eijk", combinations, moved)
        return cls(chain, T, left, right, free)


def circle(angle: ArrayLike) -> Array:
    """Give (cos, sin, 1) of angles (...) in rad, shape (3, ...)."""
    return np.array([np.cos(angle), np.sin(angle), np.ones_like(angle, dtype=float)])


def _turn(angle: float) -> Array:
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return pose


def _quantities(pose: Array) -> Array:
    direction, p = pose[:3, 2], pose[:3, 3]
    along = p @ direction
    moment = (p @ p) * direction - 2.0 * along * p
    return np.concatenate((p, direction, np.cross(p, direction), moment, [p @ p, along]))


def posture_of(equations: ClosureEquations, q3: float, q4: float, q5: float) -> Array | None:
    """Find joints 1, 2 and 6 for three angles, and improve all six on the pose.

    Returns
    -------
    ndarray, shape (6,), or None
        None where no posture with these angles gives the pose.
    """
    chain, T = equations.chain, equations.target
    values = np.einsum("rijk,i,j,k", equations.left, circle(q3), circle(q4), circle(q5))
    products = np.linalg.lstsq(equations.right[:, :8], values - equations.right[:, 8], rcond=None)[
        0
    ]
    # Products of (cos, sin, 1) of joints 1 and 2 but the last: 2 and 5 are those of joint 1 with
    # 1, 6 and 7 those of joint 2.
    q1 = float(np.arctan2(products[5], products[2]))
    q2 = float(np.arctan2(products[7], products[6]))
    q = np.array([q1, q2, q3, q4, q5, 0.0])
    back = np.linalg.inv(unpack_chain(chain.packed)[6])
    rest = np.linalg.inv(tip_poses(chain, q[None])[0] @ back) @ T @ back
    q[5] = np.arctan2(rest[1, 0], rest[0, 0])

    def error(x: Array) -> Array:
        return cast("Array", (tip_poses(chain, x[None])[0] - T)[:3].ravel())

    def slope(x: Array) -> Array:
        step = 1e-7 * np.eye(6)
        return np.array([(error(x + h) - error(x - h)) / 2e-7 for h in step]).T

    try:
        end = newton_gauss(error, slope, q, tolerance=1e-14, iterations=20)
    except BadValueError:
        return None
    if np.abs(end.residual).max() > ACCEPTED:
        return None
    turned: Array = (end.x + np.pi) % (2.0 * np.pi) - np.pi
    return turned
