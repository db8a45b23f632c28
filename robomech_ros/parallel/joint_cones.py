"""Bending limits of the joints at the ends of legs: cones about axes of base and platform."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel.argument_checks import one_or_each
from robomech_ros.typing import Array

_LEGS = 6
_KEYS = ("angles", "axes")
_LEAST_AXIS = 1e-9


@dataclass(frozen=True, eq=False)
class JointCones:
    """Cones in which the directions of six legs must stay.

    The axes (6, 3) are unit vectors from the anchors along the legs where the joints are not bent,
    those of base joints in the base, those of platform joints in the platform and so towards the
    base.  The angles (6,) say how far each leg may bend from its axis (rad), up to pi.
    """

    axes: Array
    angles: Array

    def excess(self, directions: Array) -> Array:
        """Say by how much directions (..., 6, 3) bend beyond the cones (rad), negative inside.

        They are those of the legs from the anchors, of any length, in the frame of the axes.
        """
        along = (directions * self.axes).sum(axis=-1)
        across = np.linalg.norm(np.cross(self.axes, directions), axis=-1)
        return np.asarray(np.arctan2(across, along) - self.angles)


def checked_cones(what: str, given: object) -> JointCones | None:
    """Check cones: None, or a mapping with ``axes`` (3,) or (6, 3) and ``angles``, one or six."""
    if given is None or isinstance(given, JointCones):
        return given
    if not isinstance(given, Mapping) or sorted(map(str, given)) != list(_KEYS):
        raise BadValueError(what, given, "a mapping with the keys 'axes' and 'angles'")
    axes = one_or_each(f"{what}: axes", given["axes"], _LEGS, (3,))
    norms = np.linalg.norm(axes, axis=1)
    if norms.min() < _LEAST_AXIS:
        raise BadValueError(f"{what}: axes", axes.tolist(), "directions, none of them zero")
    angles = one_or_each(f"{what}: angles", given["angles"], _LEGS, ())
    if angles.min() <= 0.0 or angles.max() > np.pi:
        raise BadValueError(f"{what}: angles", angles.tolist(), "more than 0 rad, up to pi")
    return JointCones(axes / norms[:, None], angles)
