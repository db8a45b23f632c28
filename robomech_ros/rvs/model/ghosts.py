"""Postures as ghosts: drums and bars of the whole arm, once for each posture."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from robomech_ros.kinematics import link_poses
from robomech_ros.robots import SerialChain
from robomech_ros.robots.urdf.shapes import Shape
from robomech_ros.spatial import quaternion_from_matrix
from robomech_ros.typing import Array, BoolArray

Rgb = tuple[int, int, int]

# Colours of postures for light and dark backgrounds (0 to 255).
PALETTE: tuple[Rgb, ...] = (
    (31, 119, 180),
    (230, 120, 20),
    (44, 160, 44),
    (200, 50, 60),
    (140, 95, 190),
    (125, 80, 70),
    (220, 110, 185),
    (20, 165, 180),
    (150, 150, 40),
    (70, 90, 200),
    (190, 140, 80),
    (90, 140, 110),
)
# Width of a ghost's drums and bars relative to the robot's, so that a body hides the ghost
# in it; their length is reduced by this fraction of that.
RADIUS_SCALE, ALONG = 0.8, 0.2
# Pieces of two ghosts nearer than this fraction of their radius are drawn as one: two
# coincident surfaces show as patches.
SAME, NOTHING = 0.02, 1e-6


def mixed(first: Rgb, second: Rgb, part: float) -> Rgb:
    """Return a part (0 to 1) of the way from one colour to another."""
    red, green, blue = (round(a + part * (b - a)) for a, b in zip(first, second, strict=True))
    return red, green, blue


class GhostPieces(NamedTuple):
    """Cylinders of unit radius and length along z, with their poses and scales."""

    #: Positions in the base (m), shape (m, 3).
    positions: Array
    #: Unit quaternions, scalar first, shape (m, 4).
    wxyz: Array
    #: Radius, radius, length (m), shape (m, 3).
    scales: Array
    #: Red, green, blue, 0 to 255, shape (m, 3).
    colours: NDArray[np.uint8]


class GhostMaker(Protocol):
    """Places the pieces of ghosts, of an arm or of a parallel robot."""

    @property
    def pieces(self) -> int:
        """Number of pieces of a ghost."""

    def placed(self, postures: Sequence[Array], colours: Sequence[Rgb]) -> GhostPieces:
        """Place the pieces of ghosts in postures (n,), one colour each, one ghost after another."""

    def middles(self, postures: Sequence[Array]) -> Array:
        """Return the positions of labels (k, 3) in the base (m)."""


class Ghosts:
    """The pieces of an arm, for any number of postures.

    - ``shapes``: generated shapes of its links.
    - ``radius_scale``: factor of all radii; one of two ghosts in the same posture is thinner.
    """

    def __init__(
        self,
        chain: SerialChain,
        shapes: Mapping[str, Sequence[Shape]],
        radius_scale: float = RADIUS_SCALE,
    ) -> None:
        self._chain = chain
        known = [frame.name for frame in chain.frames if frame.joints > 0]
        self._links = [name for name in known if shapes.get(name)]
        # The middle of the arm is where postures are farthest from each other.
        middle = [f.name for f in chain.frames if f.joints == (chain.n + 1) // 2]
        self._labelled = middle[0] if middle else chain.links[-1]
        rows = [(k, shape) for k, name in enumerate(self._links) for shape in shapes[name]]
        self._link = np.array([k for k, _ in rows], dtype=np.int64)
        self._pose = np.array([shape.pose for _, shape in rows]).reshape(-1, 4, 4)
        measures = [(s.radius, s.radius, s.length) for _, s in rows]
        self._scale = np.array(measures).reshape(-1, 3) * (
            (radius_scale, radius_scale, 1.0 - ALONG * (1.0 - radius_scale))
        )

    @property
    def pieces(self) -> int:
        """Number of pieces of a ghost."""
        return len(self._link)

    def middles(self, postures: Sequence[Array]) -> Array:
        """Return the positions of labels (k, 3) in the base (m), at the middle of the arm."""
        poses: Array = link_poses(self._chain, np.array(postures), [self._labelled])
        return np.asarray(poses[:, 0, :3, 3])

    def placed(self, postures: Sequence[Array], colours: Sequence[Rgb]) -> GhostPieces:
        """Place the pieces of ghosts; a piece equal to one of an earlier ghost is hidden."""
        if not len(postures) or not self.pieces:
            return placed_pieces(np.empty((0, 4, 4)), np.empty((0, 3)), (), 0)
        poses = link_poses(self._chain, np.array(postures), self._links)
        T = poses[:, self._link] @ self._pose
        scales = np.where(self._is_again(T)[..., None], NOTHING, self._scale)
        return placed_pieces(T, scales, colours, self.pieces)

    def _is_again(self, T: Array) -> BoolArray:
        """Return a mask of pieces, at T (count, pieces, 4, 4), equal to those of earlier ghosts."""
        middles, axes = T[..., :3, 3], T[..., :3, 2]
        radius, length = self._scale[:, 0], self._scale[:, 2]
        shift = np.linalg.norm(middles[:, None] - middles, axis=-1)
        # A cylinder is the same upside down.
        tilt = np.linalg.norm(np.cross(axes[:, None], axes), axis=-1)
        same = shift + 0.5 * length * tilt < SAME * radius
        return np.tril(np.moveaxis(same, -1, 0), -1).any(axis=-1).T


class NoGhosts:
    """Ghosts of a robot that has none."""

    pieces = 0

    def placed(self, postures: Sequence[Array], colours: Sequence[Rgb]) -> GhostPieces:
        """Place no piece."""
        return placed_pieces(np.empty((0, 4, 4)), np.empty((0, 3)), (), 0)

    def middles(self, postures: Sequence[Array]) -> Array:
        """Write no number."""
        return np.empty((0, 3))


def placed_pieces(T: Array, scales: Array, colours: Sequence[Rgb], pieces: int) -> GhostPieces:
    """Return cylinders at poses (..., 4, 4) (m), of these scales, as many of each colour."""
    T = T.reshape(-1, 4, 4)
    shades = np.repeat(np.array(colours, dtype=np.uint8).reshape(-1, 3), pieces, axis=0)
    wxyz = np.roll(quaternion_from_matrix(T[:, :3, :3]), 1, axis=-1)
    return GhostPieces(T[:, :3, 3], wxyz, scales.reshape(-1, 3), shades)
