"""Solve hollow wrists with offsets: two bends that turn oppositely, symmetrical to each other.

Of the four axes of such a wrist, as of paint robots, the two in the middle meet in a point off the
others.  They turn by q and -q, so that the wrist is its own mirror image between them: the first
axis and the last always meet, in a point at the distance s(q) from where each is nearest to the
middle ones, at an angle psi(q); both are functions of cos q alone.

The pose and q give the position of the point.  An arm whose first axis is at right angles to two
parallel ones reaches it in four postures, real or complex, and each leaves one condition: the angle
between the first axis of the wrist and the last.  The product of the four is a function of cos q
without branches; its zeros come from its expansion in Chebyshev polynomials.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinematics.inverse.equivalent_arms.spherical_hollow_wrist import (
    between_axes,
    outer_angles,
)
from robomech_ros.kinematics.inverse.families.merged_axes import MergedArm
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import turn_about_z, unpack_chain
from robomech_ros.typing import Array, ComplexArray

# Geometry that is off by less than the first part of the arm's size is exact.  By less than the
# second, as of angles with four digits, solutions of the ideal wrist are near enough to polish.
_EXACT = 1e-10
_NEAR = 1e-3
# Points of the expansion, and the part of its largest coefficient that is rounding.
_POINTS = 96
_ROUNDING = 1e-13
_RESOLVED = 1e-10
# Zeros closer to the real axis may be double, and conditions with a smaller residual may hold;
# polishing decides.
_OFF_AXIS = 1e-3
_SLACK = 1e-2


@dataclass(frozen=True, eq=False)
class OffsetHollowWrist:
    """An arm of three joints with such a wrist, in the frame of its first joint.

    ``front`` are the first three joints, up to the frame of the first of the wrist, and ``base``
    (4, 4) is the pose of the frame: z along the first axis, y along the second one while that is at
    zero (m). In the plane x + i z there are the second axis and the third one from there (m), then
    the foot of the wrist's first axis from the third axis, and the part along that axis (m, 1);
    ``side`` is the offset of the foot along y (m), and the part of the axis along y. ``tip`` is
    foot (m) and direction of the wrist's last axis in the frame of the tip. The turns (4, 3, 3) are
    the rotations between the axes of the wrist, and from the last to the tip. Shift and cosine (k,)
    are the coefficients of s (m) and of cos psi, Chebyshev polynomials of cos q. It is exact if
    nothing is idealised.
    """

    front: SerialChain
    base: Array
    shoulder: complex
    upper: complex
    fore: complex
    fore_axis: complex
    side: tuple[float, float]
    tip: tuple[Array, Array]
    turns: Array
    shift: Array
    cosine: Array
    exact: bool


@lru_cache(maxsize=64)
def offset_hollow_wrist(merged: MergedArm) -> OffsetHollowWrist | None:
    """Return the wrist of an arm that ends with one, else None."""
    chain, rows = merged.chain, merged.rows
    if chain.n != 7 or chain.types.any() or np.abs(rows[4] + rows[5]).max() > 0.0:
        return None
    C, size = unpack_chain(chain.packed), arm_size(chain)
    if np.count_nonzero(rows[4]) != 1 or np.abs(rows[4]).max() != 1.0:
        return None
    # Intersection of the middle axes, in the frames of the first and of the last one.
    u, d = C[5][:3, 2], C[5][:3, 3]
    square = float(u[0] ** 2 + u[1] ** 2)
    if square < _NEAR**2 or abs(np.cross(u, d)[2]) > _NEAR * size * math.sqrt(square):
        return None
    missed = abs(float(np.cross(u, d)[2])) / math.sqrt(square)
    meeting = np.array([0.0, 0.0, d[2] - u[2] * (u[0] * d[0] + u[1] * d[1]) / square, 1.0])
    first = float((C[4] @ meeting)[2])
    last = float((np.linalg.inv(C[6]) @ np.linalg.inv(C[5]) @ meeting)[2])
    cosines = np.cos(math.pi * (np.arange(_POINTS) + 0.5) / _POINTS)
    samples = []
    for sign in (1.0, -1.0):
        for q in sign * np.arccos(cosines):
            G = C[4] @ turn_about_z(q) @ C[5] @ turn_about_z(-q) @ C[6]
            axis = G[:3, 2]
            apart = G[:3, 3] + last * axis - (0.0, 0.0, first)
            if axis[2] < -0.999:
                return None
            s = apart[2] / (1.0 + axis[2])
            missed = max(missed, float(np.abs(apart - s * (axis + (0.0, 0.0, 1.0))).max()))
            samples.append((s, axis[2]))
    shifts, angles = np.array(samples).reshape(2, _POINTS, 2).transpose(2, 0, 1)
    missed = max(missed, float(np.ptp([shifts, angles], axis=1).max()))
    if missed > _NEAR * size:
        return None
    arm = _elbow_arm(C, first)
    if arm is None:
        return None
    inverse = np.linalg.inv(C[7])
    tip = inverse[:3, 3] + last * inverse[:3, 2], inverse[:3, 2]
    front = chain_of(C[:4], [0, 0, 0])
    exact = missed < _EXACT * size
    return OffsetHollowWrist(
        front, *arm, tip, C[4:, :3, :3], _expanded(shifts[0]), _expanded(angles[0]), exact
    )


def _elbow_arm(
    C: Array, height: float
) -> tuple[Array, complex, complex, complex, complex, tuple[float, float]] | None:
    """Describe three joints, the first at right angles to two parallel ones, and what follows."""
    P2 = C[1]
    P3 = P2 @ C[2]
    P4 = P3 @ C[3]
    y = P2[:3, 2]
    parallel = np.linalg.norm(np.cross(y, P3[:3, 2]))
    if abs(y[2]) > 1e-9 or parallel > 1e-9:
        return None
    base = np.eye(4)
    base[:3, :3] = np.column_stack((np.cross(y, (0.0, 0.0, 1.0)), y, (0.0, 0.0, 1.0)))
    turn = base[:3, :3].T
    second, third = turn @ P2[:3, 3], turn @ P3[:3, 3]
    axis = turn @ P4[:3, 2]
    foot = turn @ P4[:3, 3] + height * axis

    def across(v: Array) -> complex:
        return complex(v[0], v[2])

    arm = across(second), across(third - second), across(foot - third), across(axis)
    return C[0] @ base, *arm, (float(foot[1]), float(axis[1]))


def _expanded(values: Array) -> Array:
    """Return the Chebyshev coefficients of a function of cos q, known at evenly spread q."""
    k = len(values)
    waves = np.cos(math.pi * np.outer(np.arange(k), np.arange(k) + 0.5) / k)
    coefficients: Array = 2.0 / k * waves @ values
    coefficients[0] *= 0.5
    return coefficients


def _branches(
    wrist: OffsetHollowWrist, foot: Array, axis: Array, x: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray, ComplexArray]:
    """Return four postures of the arm for each cosine x (k,), and the condition that they leave.

    Foot and direction of the wrist's last axis (3,) are in the frame of the arm.  Returned are what
    the first joint is turned by and what the first three are, as complex numbers of length 1, the
    condition, and what makes its product a function without poles; the first three are (4, k).
    """
    shift = np.polynomial.chebyshev.chebval(x, wrist.shift)
    cosine = np.polynomial.chebyshev.chebval(x, wrist.cosine)
    X, Y, Z = foot[:, None] - shift * axis[:, None]
    aside = wrist.side[0] + shift * wrist.side[1]
    W = wrist.fore + shift * wrist.fore_axis
    W_bar = wrist.fore.conjugate() + shift * wrist.fore_axis.conjugate()
    far = X * X + Y * Y
    rho = np.sqrt((far - aside * aside).astype(complex))
    turned, raised, left, scale = [], [], [], np.ones(len(x), dtype=complex)
    for r in (rho, -rho):
        V = r - wrist.shoulder.real + 1j * (Z - wrist.shoulder.imag)
        V_bar = r - wrist.shoulder.real - 1j * (Z - wrist.shoulder.imag)
        K = V * V_bar + W * W_bar - abs(wrist.upper) ** 2
        root = np.sqrt(K * K - 4.0 * W * W_bar * V * V_bar)
        c, s = (r * X + aside * Y) / far, (r * Y - aside * X) / far
        for sign in (1.0, -1.0):
            beta = (K + sign * root) / (2.0 * W * V_bar)
            ahead = 0.5 * (beta * wrist.fore_axis + np.conj(wrist.fore_axis) / beta)
            up = -0.5j * (beta * wrist.fore_axis - np.conj(wrist.fore_axis) / beta)
            across = wrist.side[1] * (c * axis[1] - s * axis[0])
            left.append(ahead * (c * axis[0] + s * axis[1]) + across + up * axis[2] - cosine)
            turned.append(c + 1j * s)
            raised.append(beta)
        scale = scale * W * W_bar * V * V_bar * far
    return np.array(turned), np.array(raised), np.array(left), scale * (1.0 + cosine) ** 4


def offset_wrist_postures(wrist: OffsetHollowWrist, T: Array) -> tuple[Array, bool]:
    """List all joint values (k, 7) that give a pose T (4, 4), and tell whether they are all."""
    local = np.linalg.inv(wrist.base) @ T
    foot, axis = local[:3, :3] @ wrist.tip[0] + local[:3, 3], local[:3, :3] @ wrist.tip[1]
    x = np.cos(math.pi * (np.arange(_POINTS) + 0.5) / _POINTS)
    with np.errstate(all="ignore"):
        *_, left, scale = _branches(wrist, foot, axis, x)
        product = (left.prod(axis=0) * scale).real
    if not np.isfinite(product).all():
        return np.empty((0, 7)), False
    coefficients = _expanded(product)
    sizes = np.abs(coefficients)
    resolved = sizes[-4:].max() < _RESOLVED * sizes.max()
    kept = np.flatnonzero(sizes > _ROUNDING * sizes.max())[-1] + 1
    roots = np.polynomial.chebyshev.chebroots(coefficients[:kept])
    real = roots[np.abs(roots.imag) < _OFF_AXIS].real
    postures, regular = [], True
    for cosine in np.clip(real[np.abs(real) < 1.0 + _OFF_AXIS], -1.0, 1.0):
        with np.errstate(all="ignore"):
            turned, raised, left, _ = _branches(wrist, foot, axis, np.array([cosine]))
        for k in np.flatnonzero(np.abs(left[:, 0]) < _SLACK):
            arm = _arm_values(wrist, turned[k, 0], raised[k, 0], foot, axis, cosine)
            found, whole = _whole_postures(wrist, T, arm, math.acos(cosine))
            postures.extend(found)
            regular = regular and whole
    complete = bool(wrist.exact and resolved and regular)
    return np.array(postures).reshape(-1, 7), complete


def _arm_values(
    wrist: OffsetHollowWrist,
    turned: complex,
    raised: complex,
    foot: Array,
    axis: Array,
    cosine: float,
) -> Array:
    """Return the values of the first three joints of a branch; a complex one gives the nearest."""
    shift = float(np.polynomial.chebyshev.chebval(cosine, wrist.shift))
    first = float(np.angle(turned))
    point = turn_about_z(-first)[:3, :3] @ (foot - shift * axis)
    V = complex(point[0], point[2]) - wrist.shoulder
    beta = raised / abs(raised)
    alpha = (V - beta * (wrist.fore + shift * wrist.fore_axis)) / wrist.upper
    # Turns about y go from z to x, against those of x + i z.
    second = -float(np.angle(alpha))
    return np.array([first, second, -float(np.angle(beta)) - second])


def _whole_postures(
    wrist: OffsetHollowWrist, T: Array, arm: Array, angle: float
) -> tuple[list[Array], bool]:
    """Add the joints of the wrist, for both signs of the drive, to values (3,) of the arm."""
    front = forward_kinematics(wrist.front, arm)[:3, :3]
    W = front.T @ T[:3, :3] @ wrist.turns[3].T
    found, regular = [], True
    for q in (angle, -angle):
        V = between_axes(wrist.turns, (q, -q))
        first, last, alone = outer_angles(W, V)
        regular = regular and alone
        found.append(np.array([*arm, first, q, -q, last]))
    return found, regular
