"""Target poses as they come from a caller, checked and laid out for the kernels."""

import numpy as np

from robomech_ros._kernels.inverse.poses import (
    IMPROPER,
    NOT_FINITE,
    NOT_RIGID,
    TOO_FAR,
    clean_poses,
)
from robomech_ros._kernels.tolerances import LARGEST_LENGTH, ROTATION_ERROR
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial.arrays import real_array
from robomech_ros.spatial.matrices import rotation_error
from robomech_ros.typing import Array, ArrayLike

_ARRAY, _FLOAT = np.ndarray, np.dtype(np.float64)
_ONE, _MANY = "(4, 4); inverse_kinematics_batch takes many", "(m, 4, 4)"


def as_target(T: ArrayLike) -> Array:
    """Return one pose as float64 (4, 4), of any memory layout, its entries not looked at.

    It is the array itself where that is one of this kind.
    """
    if type(T) is _ARRAY and T.dtype is _FLOAT and T.shape == (4, 4):
        return T
    given = real_array("T", T)
    if given.shape != (4, 4):
        raise WrongSizeError("T", given.shape, _ONE)
    return given


def as_targets(T: ArrayLike, what: str = "T", batch: bool = False) -> Array:
    """Return poses as contiguous float64 (m, 4, 4), a copy, rotations made exactly orthogonal.

    One pose (4, 4) is expected, or many for a batch (m); ``what`` names them in messages.
    """
    given = T if type(T) is _ARRAY and T.dtype is _FLOAT else real_array(what, T)
    if given.ndim != (3 if batch else 2) or given.shape[-2:] != (4, 4):
        raise WrongSizeError(what, given.shape, _MANY if batch else _ONE)
    poses = np.array(given, order="C", ndmin=3)
    fault = clean_poses(poses, ROTATION_ERROR)
    if fault:
        _raise(poses, f"{what}[{{}}]" if batch else what)
    return poses


def _raise(poses: Array, what: str) -> None:
    """Raise the error of the first pose at fault."""
    for index in range(len(poses)):
        name = what.format(index)
        pose = poses[index : index + 1].copy()
        fault = clean_poses(pose, ROTATION_ERROR)
        if fault == NOT_FINITE:
            raise NonFiniteError(name, poses[index])
        if fault == NOT_RIGID:
            raise BadValueError(
                f"last row of {name}", poses[index, 3].tolist(), f"0, 0, 0, 1 to {ROTATION_ERROR:g}"
            )
        if fault == TOO_FAR:
            raise BadValueError(
                f"position of {name}",
                poses[index, :3, 3].tolist(),
                f"at most {LARGEST_LENGTH:g} m along each axis",
            )
        if fault == IMPROPER:
            off = float(rotation_error(poses[index, :3, :3]))
            raise BadValueError(
                f"rotation of {name}",
                poses[index, :3, :3].tolist(),
                f"a rotation matrix to {ROTATION_ERROR:g}; it is off by {off:.3g}",
            )
