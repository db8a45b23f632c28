"""The matrices of the stacked twists and wrenches of a chain: constraints and shaping.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.5.
"""

import numpy as np

from robomech_ros.dynamics.posed_bodies import PosedBodies
from robomech_ros.spatial.cross_product import cross_product_matrix
from robomech_ros.spatial.screws.transfers import twist_transfer_matrix
from robomech_ros.typing import Array


def twist_shaping(bodies: PosedBodies) -> Array:
    """Form T (..., 6 n, n): ``[e_j; e_j x (c_i - o_j)]`` or ``[0; e_j]`` for j <= i."""
    n = len(bodies.masses)
    T = np.zeros((*bodies.centres.shape[:-2], n, 6, n))
    for i in range(n):
        for j in range(i + 1):
            e = bodies.axes[..., j, :]
            if bodies.revolute[j]:
                arm = bodies.centres[..., i, :] - bodies.origins[..., j, :]
                T[..., i, :3, j] = e
                T[..., i, 3:, j] = np.cross(e, arm)
            else:
                T[..., i, 3:, j] = e
    return T.reshape(*T.shape[:-3], 6 * n, n)


def twist_shaping_rate(bodies: PosedBodies, twists: Array) -> Array:
    """Differentiate T in time, for twists (..., n, 6) of the bodies."""
    n = len(bodies.masses)
    T_dot = np.zeros((*bodies.centres.shape[:-2], n, 6, n))
    for j in range(n):
        e, omega = bodies.axes[..., j, :], twists[..., j, :3]
        e_dot = np.cross(omega, e)
        o = bodies.origins[..., j, :]
        o_dot = twists[..., j, 3:] + np.cross(omega, o - bodies.centres[..., j, :])
        for i in range(j, n):
            if bodies.revolute[j]:
                arm = bodies.centres[..., i, :] - o
                arm_dot = twists[..., i, 3:] - o_dot
                T_dot[..., i, :3, j] = e_dot
                T_dot[..., i, 3:, j] = np.cross(e_dot, arm) + np.cross(e, arm_dot)
            else:
                T_dot[..., i, 3:, j] = e_dot
    return T_dot.reshape(*T_dot.shape[:-3], 6 * n, n)


def base_shaping(arms: Array) -> Array:
    """Transfer a twist of the base's origin to points at these arms (..., n, 3) from it."""
    T_0 = twist_transfer_matrix(np.zeros(3), arms)
    return T_0.reshape(*arms.shape[:-2], -1, 6)


def constraints(bodies: PosedBodies) -> tuple[Array, Array]:
    """Rows ``E_i (omega_i - omega_i-1)`` and ``v_i - v_i-1 + R_i omega_i + D_i-1 omega_i-1``.

    A slide leaves no turn, and its axis is free: there E_i stands in front of the lower rows.
    """
    n, batch = len(bodies.masses), bodies.centres.shape[:-2]
    K = np.zeros((*batch, 6 * n, 6 * (n + 1)))
    previous = np.zeros((*batch, 3))
    for i in range(n):
        E = cross_product_matrix(bodies.axes[..., i, :])
        R = cross_product_matrix(bodies.centres[..., i, :] - bodies.origins[..., i, :])
        D = cross_product_matrix(bodies.origins[..., i, :] - previous)
        one = np.broadcast_to(np.eye(3), E.shape)
        turn, slide = (E, one) if bodies.revolute[i] else (one, E)
        row, own, before = 6 * i, 6 * (i + 1), 6 * i
        K[..., row : row + 3, own : own + 3] = turn
        K[..., row : row + 3, before : before + 3] = -turn
        K[..., row + 3 : row + 6, own : own + 3] = slide @ R
        K[..., row + 3 : row + 6, own + 3 : own + 6] = slide
        K[..., row + 3 : row + 6, before : before + 3] = slide @ D
        K[..., row + 3 : row + 6, before + 3 : before + 6] = -slide
        previous = bodies.centres[..., i, :]
    return K[..., 6:], K[..., :6]


def drive_wrenches(bodies: PosedBodies) -> Array:
    """Moments about, or forces along the axes, on the body of each joint and back on the last."""
    n = len(bodies.masses)
    A = np.zeros((*bodies.centres.shape[:-2], n, 6, n))
    for j in range(n):
        e = bodies.axes[..., j, :]
        for i, sign in ((j, 1.0), (j - 1, -1.0)):
            if i < 0:
                continue
            if bodies.revolute[j]:
                A[..., i, :3, j] = sign * e
            else:
                arm = bodies.origins[..., j, :] - bodies.centres[..., i, :]
                A[..., i, :3, j] = sign * np.cross(arm, e)
                A[..., i, 3:, j] = sign * e
    return A.reshape(*A.shape[:-3], 6 * n, n)
