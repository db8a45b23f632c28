"""The matrices of a mechanism in motion, and the wrenches in its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.dynamics.layout import LINEAR_ACCELERATION, TIP_WRENCH
from robomech_ros.dynamics import ConstrainedBodies, constraint_reactions
from robomech_ros.dynamics.formulations.stacked_matrices import (
    drive_wrenches,
    twist_shaping,
    twist_shaping_rate,
)
from robomech_ros.dynamics.posed_bodies import PosedBodies, posed_bodies
from robomech_ros.parallel.dynamics.model import limb_bodies
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.robots import Body, SerialChain
from robomech_ros.spatial.cross_product import cross_product_matrix
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class JointReactions:
    """Wrenches in the joints of a mechanism.

    Attributes
    ----------
    wrenches : ndarray, shape (n, 6)
        Of each joint, moment and force [n; f] that the link before it exerts on the one behind it,
        at the joint's origin, in the axes of the base (N m and N); efforts of drives included.
    unique : bool
        Whether these are the only ones.  Where a robot is overconstrained, as a planar one is, they
        are those with the least sum of squares of forces and of moments over the robot's size.
    redundant : int
        How many constraints follow from the others.
    """

    wrenches: Array
    unique: bool
    redundant: int


def bodies_in_motion(
    mechanism: Mechanism, q: Array, qd: Array, N: Array, N_dot: Array
) -> tuple[ConstrainedBodies, list[PosedBodies]]:
    """Form the matrices of all links, one for each joint; the platform is the last of limb 1.

    The last link of every other limb has no mass: it is where the platform is.  With all joints
    and their rates, q and qd (..., n), the complement of the loops and its rate are (..., n, m).
    """
    n, batch = mechanism.n, q.shape[:-1]
    T, T_dot, A = (np.zeros((*batch, 6 * n, n)) for _ in range(3))
    posed, start = [], 0
    for limb, given in zip(mechanism.limbs, limb_bodies(mechanism), strict=True):
        end = start + limb.chain.n
        bodies = _posed(limb.chain, given, q[..., start:end])
        shaping = twist_shaping(bodies)
        twists = (shaping @ qd[..., start:end, None])[..., 0].reshape(*batch, -1, 6)
        block = (..., slice(6 * start, 6 * end), slice(start, end))
        T[block], T_dot[block] = shaping, twist_shaping_rate(bodies, twists)
        A[block] = drive_wrenches(bodies)
        posed.append(bodies)
        start = end
    drives = [drive for limb in mechanism.limbs for drive in limb.chain.drives]
    system = ConstrainedBodies(
        masses=np.concatenate([one.masses for one in posed]),
        inertias=np.concatenate([one.inertias for one in posed], axis=-3),
        T=T @ N,
        T_dot=T_dot @ N + T @ N_dot,
        rates=qd[..., mechanism.drive_index],
        rotors=np.array([drive.reflected_inertia for drive in drives]),
        N=N,
        N_dot=N_dot,
        A=A[..., mechanism.drive_index],
    )
    return system, posed


def _posed(chain: SerialChain, given: list[Body | None], q: Array) -> PosedBodies:
    masses = np.array([0.0 if one is None else one.mass for one in given])
    centres = np.array([np.zeros(3) if one is None else one.com for one in given])
    moments = np.array([np.zeros((3, 3)) if one is None else one.inertia for one in given])
    return posed_bodies(chain, q, (masses, centres, moments))


def joint_reactions(
    mechanism: Mechanism, q: Array, qd: Array, N: Array, N_dot: Array, gains: Array, around: Array
) -> JointReactions:
    """Find the wrenches in all joints, in one state of :func:`bodies_in_motion`.

    The gains (m,) are accelerations of the drives, and ``around`` (15,) is what surrounds the
    mechanism: :func:`robomech_ros.dynamics.model.surroundings`.
    """
    system, posed = bodies_in_motion(mechanism, q, qd, N, N_dot)
    platform = int(mechanism.loops.starts[1]) - 1
    applied = system.gravity_wrenches(-around[LINEAR_ACCELERATION:TIP_WRENCH]).reshape(-1, 6)
    wrench = around[TIP_WRENCH:]
    arm = posed[0].tip - posed[0].centres[-1]
    applied[platform, :3] += wrench[:3] + np.cross(arm, wrench[3:])
    applied[platform, 3:] += wrench[3:]
    kept = system.constraint_wrenches(gains, applied.ravel())
    efforts = system.generalised(system.inertia_wrenches(gains) - applied.ravel())
    n, weights = mechanism.n, np.array([mechanism.size] * 3 + [1.0] * 3)
    axes, origins, centres, turns = (
        np.concatenate([getattr(one, key) for one in posed])
        for key in ("axes", "origins", "centres", "revolute")
    )
    before = np.arange(-1, n - 1)
    before[mechanism.loops.starts[:-1]] = -1
    # A wrench [n; f] at a joint acts on the body behind it, and reversed on that before it; a loop
    # is closed by a weld of the last body of a limb to the platform.
    rows, spans = [], []
    for j in range(n):
        free = np.concatenate((axes[j], np.zeros(3)) if turns[j] else (np.zeros(3), axes[j]))
        spans.append(np.linalg.svd(free[None])[2][1:] * weights)
        rows.append(_acting(spans[-1], origins[j], centres, j, int(before[j])))
    for end in mechanism.loops.starts[2:].tolist():
        rows.append(_acting(np.diag(weights), centres[end - 1], centres, end - 1, platform))
    found = constraint_reactions(np.concatenate(rows), kept)
    joints = np.array([found.multipliers[5 * j : 5 * j + 5] @ spans[j] for j in range(n)])
    for j, effort in zip(mechanism.drive_index.tolist(), efforts.tolist(), strict=True):
        joints[j, slice(0, 3) if turns[j] else slice(3, 6)] += effort * axes[j]
    return JointReactions(joints, found.unique, found.redundant)


def _acting(span: Array, point: Array, centres: Array, behind: int, before: int) -> Array:
    """Return rows (k, 6 n) of wrenches (k, 6) at a point on one body, and reversed on another."""
    rows = np.zeros((len(span), len(centres), 6))
    for body, sign in ((behind, 1.0), (before, -1.0)):
        if body >= 0:
            arm = cross_product_matrix(point - centres[body])
            rows[:, body, :3] = sign * (span[:, :3] + span[:, 3:] @ arm.T)
            rows[:, body, 3:] = sign * span[:, 3:]
    return rows.reshape(len(span), -1)
