"""The Frenet-Serret frame of a curve, its curvature and torsion, and how they change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.numerics.nonlinear import bisected
from robomech_ros.trajectory.paths.arc_length import by_unit_speed, dot
from robomech_ros.trajectory.paths.curve import Curve, as_curve
from robomech_ros.trajectory.paths.curve_arguments import as_parameters
from robomech_ros.typing import Array, ArrayLike, BoolArray

# Curvature times length below which a curve is straight there: nine digits of its second
# derivative are gone, and no normal is left in the others.
STRAIGHT = 1e-9

# Where a curved neighbour of a straight place is looked for: so many places in each part between
# breaks, and so many halvings to the last one that is curved.
_PLACES = 64
_HALVINGS = 50


@dataclass(frozen=True, eq=False)
class FrenetSerret:
    """Moving frame of a curve at m parameters; the derivatives are with respect to arc length.

    Attributes
    ----------
    frame : ndarray, shape (m, 3, 3)
        Columns e_t, e_n, e_b: tangent, normal and binormal in the frame of the curve's points; a
        rotation matrix.
    speed : ndarray, shape (m,)
        ds/du (m per unit of the parameter).
    curvature, torsion : ndarray, shape (m,)
        kappa >= 0 and tau (1/m); both 0 where the curve is straight.
    curvature_rate, torsion_rate : ndarray, shape (m,)
        Their derivatives (1/m^2); 0 where the curve is straight.
    """

    frame: Array
    speed: Array
    curvature: Array
    torsion: Array
    curvature_rate: Array
    torsion_rate: Array

    @property
    def darboux(self) -> Array:
        """Darboux vector tau e_t + kappa e_b (rad/m), shape (m, 3): the frame's turn per length."""
        return self._along(self.torsion, self.curvature)

    @property
    def darboux_rate(self) -> Array:
        """Its derivative tau' e_t + kappa' e_b (rad/m^2), shape (m, 3)."""
        return self._along(self.torsion_rate, self.curvature_rate)

    def _along(self, tangent: Array, binormal: Array) -> Array:
        return (
            tangent[..., None] * self.frame[..., :, 0] + binormal[..., None] * self.frame[..., :, 2]
        )


def frenet_serret(curve: Curve, u: ArrayLike) -> FrenetSerret:
    r"""Find the Frenet-Serret frame of a curve, its curvature and its torsion.

    Where the curve is straight there is no normal, and the frame goes on without turning about
    the tangent (rotation-minimising): the normal is that of the nearest curved place before, or
    after if there is none before, carried over by the least rotation between the two tangents.
    On a curve that is straight all over it is the coordinate axis most across it, made normal.
    At an isolated inflection the frame is therefore that from before; where the curve bends to
    the other side after it, the frame steps there by a turn of pi about the tangent, as it does
    by definition.

    With derivatives of the point p by the parameter u

    .. math::

       \kappa = \frac{|p' \times p''|}{|p'|^3}, \qquad
       \tau = \frac{p' \cdot (p'' \times p''')}{|p' \times p''|^2},

    and with respect to the arc length s

    .. math::

       \frac{d e_t}{ds} = \kappa e_n, \qquad
       \frac{d e_n}{ds} = -\kappa e_t + \tau e_b, \qquad
       \frac{d e_b}{ds} = -\tau e_n.

    Parameters
    ----------
    curve : Curve
        Over any parameter.
    u : array_like, shape () or (m,)
        Parameters; at an inner break the part after it counts.

    Returns
    -------
    FrenetSerret
        Without the axis m for a single parameter.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 11.2.

    Examples
    --------
    >>> from robomech_ros.trajectory import frenet_serret, helix
    >>> found = frenet_serret(helix(radius=2.0, rise=1.0, angle=6.0), 1.0)
    >>> round(float(found.curvature), 6), round(float(found.torsion), 6)
    (0.4, 0.2)
    """
    curve = as_curve("curve", curve)
    inside = as_parameters("parameter", u, float(curve.breaks[0]), float(curve.breaks[-1]))
    found = _frames(curve, np.atleast_1d(inside))
    if inside.ndim:
        return found
    return FrenetSerret(*(getattr(found, name)[0] for name in FrenetSerret.__dataclass_fields__))


def _frames(curve: Curve, u: Array) -> FrenetSerret:
    rows = curve.derivatives(u)
    p = by_unit_speed(rows)
    curved = _is_curved(curve, rows, p)
    kappa = np.linalg.norm(p[2], axis=-1)
    divisor = np.where(curved, kappa, 1.0)
    tangent = p[1]
    normal = p[2] / divisor[:, None]
    if not curved.all():
        normal[~curved] = _carried_normals(curve, u[~curved], tangent[~curved])
    binormal = np.cross(tangent, normal)
    # p'' = kappa e_n;  p''' . e_n = kappa';  p''' . e_b = kappa tau;
    # p'''' . e_b = 2 kappa' tau + kappa tau'.
    kappa_rate = dot(p[3], normal)
    tau = dot(p[3], binormal) / divisor
    tau_rate = (dot(p[4], binormal) - 2.0 * kappa_rate * tau) / divisor
    return FrenetSerret(
        np.stack([tangent, normal, binormal], axis=-1),
        np.linalg.norm(rows[1], axis=-1),
        *(np.where(curved, value, 0.0) for value in (kappa, tau, kappa_rate, tau_rate)),
    )


def _is_curved(curve: Curve, rows: Array, p: Array) -> BoolArray:
    """Return True where the curvature (1/m) exceeds rounding over the length of the curve."""
    length = np.linalg.norm(rows[1], axis=-1) * (curve.breaks[-1] - curve.breaks[0])
    return np.linalg.norm(p[2], axis=-1) * length > STRAIGHT


def _carried_normals(curve: Curve, u: Array, tangents: Array) -> Array:
    """Find normals at straight places, carried over from curved ones."""
    table = _places(curve)
    _, _, curved = _normals(curve, table)
    known = table[curved]
    if not len(known):
        axes = np.eye(3)[np.argmin(np.abs(tangents), axis=-1)]
        return _carried(axes, tangents, tangents)
    before = np.searchsorted(known, u) - 1
    # The nearest curved places.
    first = known[np.maximum(before, 0)]
    source, _ = bisected(first, u, lambda places: _normals(curve, places)[2], _HALVINGS)
    from_tangents, normals, _ = _normals(curve, source)
    return _carried(normals, from_tangents, tangents)


def _normals(curve: Curve, u: Array) -> tuple[Array, Array, BoolArray]:
    """Tangents, normals (of any length where straight), and whether the curve is curved."""
    rows = curve.derivatives(u)
    p = by_unit_speed(rows)
    length = np.linalg.norm(p[2], axis=-1, keepdims=True)
    return p[1], p[2] / np.where(length > 0.0, length, 1.0), _is_curved(curve, rows, p)


def _places(curve: Curve) -> Array:
    """Places inside every part between two breaks, and both its ends from within."""
    breaks = curve.breaks
    inner = (np.arange(_PLACES) + 0.5) / _PLACES
    spread = breaks[:-1, None] + np.diff(breaks)[:, None] * inner
    ends = np.nextafter(breaks[1:], breaks[:-1])[:, None]
    return np.concatenate([breaks[:-1, None], spread, ends], axis=1).ravel()


def _carried(vectors: Array, before: Array, after: Array) -> Array:
    """Turn vectors by the least rotation from one direction to another; make them normal to it."""
    between = before + after
    scale = np.maximum(1.0 + dot(before, after), np.finfo(np.float64).tiny)
    turned = vectors - between * (dot(vectors, after) / scale)[:, None]
    turned -= after * dot(turned, after)[:, None]
    return turned / np.linalg.norm(turned, axis=-1, keepdims=True)
