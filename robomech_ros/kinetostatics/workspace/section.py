"""The positioning part of an arm, and the plane section that its first joint sweeps.

The first joint moves the whole space of the other two along circles about its axis, or along its
slide.  What is left is a map of two joint values to the plane: ``(rho, z)`` in the half-plane that
turns about axis 1, or ``(x, y)`` across a slide.  Its singular set is where det J21 vanishes.  A
planar arm is its own section: its two joints count as the second and the third, after a slide
across its plane that stands still.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.4.1.
"""

from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from robomech_ros.errors import BadValueError, MissingLimitsError
from robomech_ros.kinematics.tolerances import ARM_RANK
from robomech_ros.kinetostatics.workspace.positioning_part import PositioningPart, positioning_part
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array, BoolArray

# Nodes in each direction on which it is looked whether the arm is singular everywhere.
_LOOK = 24


@dataclass(frozen=True, eq=False)
class WorkspaceSection:
    """A point carried by three joints, seen in the frame in which joint 1 is the z axis.

    The name of a planar arm's slide is empty. ``base`` (4, 4) is the frame of joint 1 in the base
    of the chain, ``first`` and ``second`` (4, 4) are the constant transforms from joint 1 to joint
    2, and from joint 2 to joint 3, and ``point`` (3,) is the point in the frame that moves with
    joint 3 (m). Lower and upper ends (3,) are the ranges of the joints (rad or m); those of a
    turning joint span a turn at the most. ``round`` (3,) are those that turn all the way round, or,
    of the first joint, have no limit. The size is that of the arm, its slides at their farthest
    (m). A planar arm is flat.
    """

    names: tuple[str, str, str]
    slides: tuple[bool, bool, bool]
    base: Array
    first: Array
    second: Array
    point: Array
    lower: Array
    upper: Array
    round: BoolArray
    size: float
    flat: bool

    def derivatives(self, u: Array, v: Array, order: int = 2) -> tuple[Array, ...]:
        """Return p (3, ...) before joint 1 moves it, then p_u, p_v, and p_uu, p_uv, p_vv.

        The values u and v (...) of joints 2 and 3 may be complex.
        """
        u, v = np.broadcast_arrays(u, v)
        inner = _moved(self.slides[2], v, self._spread(self.point, v))
        s = [self._through(self.second, inner[0], shifted=True)]
        s += [self._through(self.second, part, shifted=False) for part in inner[1 : order + 1]]
        outer = [_moved(self.slides[1], u, part, shifts=k == 0) for k, part in enumerate(s)]
        parts = [outer[0][0]]
        if order >= 1:
            parts += [outer[0][1], outer[1][0]]
        if order >= 2:
            parts += [outer[0][2], outer[1][1], outer[2][0]]
        return tuple(
            self._through(self.first, part, shifted=k == 0) for k, part in enumerate(parts)
        )

    @staticmethod
    def _spread(vector: Array, like: Array) -> Array:
        return np.broadcast_to(vector.reshape((3,) + (1,) * like.ndim), (3, *like.shape))

    @staticmethod
    def _through(T: Array, vectors: Array, *, shifted: bool) -> Array:
        turned: Array = (T[:3, :3] @ vectors.reshape(3, -1)).reshape(vectors.shape)
        if shifted:
            turned = turned + T[:3, 3].reshape((3,) + (1,) * (vectors.ndim - 1))
        return turned

    def image(self, u: Array, v: Array) -> Array:
        """Return the coordinates in the section (m), shape (..., 2): rho and z, or x and y."""
        (p,) = self.derivatives(u, v, 0)
        return self.coordinates(np.moveaxis(p, 0, -1))

    def coordinates(self, points: Array) -> Array:
        """Return those of points (..., 3) in the frame of joint 1 (m)."""
        if self.slides[0]:
            return points[..., :2]
        return np.stack((np.hypot(points[..., 0], points[..., 1]), points[..., 2]), axis=-1)

    def image_gradient(self, u: Array, v: Array) -> Array:
        """Return the derivatives of the coordinates, shape (k, 2, 2) (m per rad or m)."""
        p, pu, pv = self.derivatives(u, v, 1)
        if self.slides[0]:
            first, second = (pu[0], pv[0]), (pu[1], pv[1])
        else:
            rho = np.maximum(np.hypot(p[0], p[1]), 1e-300)
            first = tuple((p[0] * d[0] + p[1] * d[1]) / rho for d in (pu, pv))
            second = (pu[2], pv[2])
        return np.stack((np.stack(first, -1), np.stack(second, -1)), axis=1)

    def regular(self, u: Array, v: Array) -> tuple[Array, ...]:
        """Return derivatives a_u, a_v, a_uu, a_uv, a_vv, and those of b, of smooth coordinates.

        These are rho^2 / 2 and z, or x and y.
        """
        p, pu, pv, puu, puv, pvv = self.derivatives(u, v)
        if self.slides[0]:
            return pu[0], pv[0], puu[0], puv[0], pvv[0], pu[1], pv[1], puu[1], puv[1], pvv[1]

        def across(a: Array, b: Array) -> Array:
            return a[0] * b[0] + a[1] * b[1]

        return (
            across(p, pu),
            across(p, pv),
            across(pu, pu) + across(p, puu),
            across(pu, pv) + across(p, puv),
            across(pv, pv) + across(p, pvv),
            pu[2], pv[2], puu[2], puv[2], pvv[2],
        )  # fmt: skip

    def determinant(self, u: Array, v: Array) -> Array:
        """Return det J21 (m^3 where all turn), shape (...)."""
        p, pu, pv = self.derivatives(u, v, 1)
        if self.slides[0]:
            return pu[0] * pv[1] - pv[0] * pu[1]
        au, av = p[0] * pu[0] + p[1] * pu[1], p[0] * pv[0] + p[1] * pv[1]
        return au * pv[2] - av * pu[2]

    def determinant_gradient(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return det J21 and its derivatives by the two joint values, shape (...) each."""
        au, av, auu, auv, avv, bu, bv, buu, buv, bvv = self.regular(u, v)
        return (
            au * bv - av * bu,
            auu * bv + au * buv - auv * bu - av * buu,
            auv * bv + au * bvv - avv * bu - av * buv,
        )

    def in_frame(self, points: Array) -> Array:
        """Return points (..., 3) of the base in the frame of joint 1 (m)."""
        return (points - self.base[:3, 3]) @ self.base[:3, :3]

    def on_section(self, coordinates: Array) -> Array:
        """Return points of the base (..., 3) at azimuth or height 0 of coordinates (..., 2) (m)."""
        local = np.zeros((*coordinates.shape[:-1], 3))
        local[..., (0, 1) if self.slides[0] else (0, 2)] = coordinates
        return self.in_base(local)

    def in_base(self, points: Array) -> Array:
        """Return points (..., 3) of the frame of joint 1 in the base (m)."""
        return points @ self.base[:3, :3].T + self.base[:3, 3]

    def over(self, unit: float) -> "WorkspaceSection":
        """Return the same arm with all lengths divided by a unit (m)."""
        frames = [self.base.copy(), self.first.copy(), self.second.copy()]
        for T in frames:
            T[:3, 3] /= unit
        divisor = np.where(np.array(self.slides) & ~self.round, unit, 1.0)
        return replace(
            self,
            base=frames[0],
            first=frames[1],
            second=frames[2],
            point=self.point / unit,
            lower=self.lower / divisor,
            upper=self.upper / divisor,
            size=self.size / unit,
        )


def _moved(slides: bool, value: Array, vectors: Array, *, shifts: bool = True) -> list[Array]:
    """Apply a joint to vectors (3, ...): the result and its first two derivatives.

    A slide shifts points only, not their derivatives by other joints (``shifts``).
    """
    x, y, z = vectors
    if slides:
        still = np.zeros_like(value)
        along = np.ones_like(value) if shifts else still
        shifted = z + value if shifts else z
        return [
            np.stack((x + still, y + still, shifted + still)),
            np.stack((still, still, along)),
            np.stack((still, still, still)),
        ]
    c, s = np.cos(value), np.sin(value)
    a, b = c * x - s * y, s * x + c * y
    none = np.zeros_like(a)
    return [np.stack((a, b, z + none)), np.stack((-b, a, none)), np.stack((-a, -b, none))]


def section_of(chain: SerialChain, *, respect_limits: bool = True) -> WorkspaceSection:
    """Make the section of an arm's positioning part.

    ``respect_limits`` is about turning joints and the first joint; other slides keep theirs.
    """
    part = positioning_part(chain)
    flat = part.plane is not None
    joints = slice(0, part.joints)
    names = (*[""] * flat, *chain.joint_names[joints])
    slides = np.array([*[True] * flat, *(chain.types[joints] == PRISMATIC)])
    lower = np.array([*[-np.inf] * flat, *chain.lower[joints]])
    upper = np.array([*[np.inf] * flat, *chain.upper[joints]])
    if not respect_limits:
        free = ~slides
        free[0] = True
        lower[free], upper[free] = -np.inf, np.inf
    endless = ~np.isfinite(upper - lower)
    if (endless[1:] & slides[1:]).any():
        raise MissingLimitsError("position", [names[j] for j in (1, 2) if endless[j] and slides[j]])
    whole = endless | (~slides & (upper - lower >= 2.0 * np.pi))
    lower, upper = np.where(whole, -np.pi, lower), np.where(whole, np.pi, upper)
    base, first, second = _frames(chain, part)
    lengths = [
        float(np.linalg.norm(vector)) for vector in (first[:3, 3], second[:3, 3], part.point)
    ]
    travel = [max(abs(lower[j]), abs(upper[j])) for j in (1, 2) if slides[j]]
    section = WorkspaceSection(
        (names[0], names[1], names[2]),
        (bool(slides[0]), bool(slides[1]), bool(slides[2])),
        base,
        first,
        second,
        part.point,
        lower,
        upper,
        whole,
        sum(lengths) + float(sum(travel)),
        flat,
    )
    _check_moves(chain, section)
    return section


def _frames(chain: SerialChain, part: PositioningPart) -> tuple[Array, Array, Array]:
    """Return the frame of the first joint in the base, and the constant transforms from there."""
    C = chain.transforms
    if part.plane is None:
        return C[0], C[1], C[2]
    origin, normal = C[0][:3, 3], part.plane[:, 2]
    # The plane is at the height of the point, wherever along their axes the joints are.
    point = (C[0] @ C[1] @ (*part.point, 1.0))[:3]
    base = np.eye(4)
    base[:3, :3] = part.plane
    base[:3, 3] = origin + ((point - origin) @ normal) * normal
    first: Array = rigid_inverse(base) @ C[0]
    return base, first, C[1]


def _check_moves(chain: SerialChain, section: WorkspaceSection) -> None:
    """Refuse a part that is singular in every posture, or of which a joint cannot move."""
    u, v = np.meshgrid(
        *(np.linspace(section.lower[j], section.upper[j], _LOOK) + 0.01 for j in (1, 2))
    )
    scale = section.size ** (3 - sum(section.slides))
    still = not (section.lower < section.upper).all()
    if still or not section.size or np.abs(section.determinant(u, v)).max() <= ARM_RANK * scale:
        raise_on_surface(chain)


def raise_on_surface(chain: SerialChain) -> NoReturn:
    """Refuse an arm whose positioning part does not fill a region."""
    expected = "one whose first joints move a point in all directions, not on a surface only"
    raise BadValueError("chain", chain.name, expected)
