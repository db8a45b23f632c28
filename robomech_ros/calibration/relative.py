"""The direct method: A X = X B from relative motions, by invariants."""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import InconsistentDataError, WrongSizeError
from robomech_ros.spatial.poses import as_pose, assembled
from robomech_ros.spatial.transformations.redundant_sensing import frames_between, single_match
from robomech_ros.typing import Array, ArrayLike

# Positions that miss by more than this part of the distances contradict each other, unless it is so
# little (m) that it may be noise.
_CHAOS, _NOISE = 0.3, 0.01


def relative_hand_eye(A: ArrayLike, B: ArrayLike) -> Array:
    r"""Solve A X = X B for the pose X without iteration, from two motions or more.

    The axial vectors of the rotations are the same vectors in two frames,
    :math:`\mathrm{vect}(A_i) = X \mathrm{vect}(B_i)`, which gives the rotation; then

    .. math:: (R_{A_i} - 1) t_X = R_X t_{B_i} - t_{A_i}

    gives the position, in least squares.  Euler-Rodrigues parameters take the place of the axial
    vectors, which vanish at half turns; of the frames that half turns about axes at right angles
    leave open, the positions tell which one is right.

    Parameters
    ----------
    A, B : array_like, shape (k, 4, 4)
        k motions, two or more, about axes that are not all parallel: of the hand in its first
        frame, and of the sensor in its own.

    Returns
    -------
    ndarray, shape (4, 4)
        ``T_hand_sensor``.

    Raises
    ------
    InconsistentDataError, UnderdeterminedError
        Other angles for both, or motions that no pose matches, such as inverted ones; no rotations,
        all about parallel axes, along which the position is then free, or half turns about axes at
        right angles whose positions do not tell either.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 2.7.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.calibration import relative_hand_eye
    >>> from robomech_ros.spatial import inverse_pose, pose_exponential
    >>> X = pose_exponential([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    >>> B = pose_exponential([[1.0, 0.0, 0.2, 0.1, 0.0, 0.3], [0.0, 1.0, 0.5, 0.0, 0.2, 0.0]])
    >>> np.allclose(relative_hand_eye(X @ B @ inverse_pose(X), B), X)
    True
    """
    first, second = as_pose(A, what="A"), as_pose(B, what="B")
    if first.ndim != 3 or first.shape != second.shape or len(first) < 2:
        raise WrongSizeError(
            "motions", (first.shape[:-2], second.shape[:-2]), "(k, 4, 4) each, k >= 2"
        )
    frames, misfits = frames_between(first[:, :3, :3], second[:, :3, :3])
    left = (first[:, :3, :3] - np.eye(3)).reshape(-1, 3)
    right = second[:, :3, 3] @ np.swapaxes(frames, 1, 2) - first[:, :3, 3]
    positions = np.linalg.lstsq(left, right.reshape(len(frames), -1).T, rcond=None)[0].T
    missed = (positions @ left.T - right.reshape(len(frames), -1)) ** 2
    reach = float(np.mean(first[:, :3, 3] ** 2 + second[:, :3, 3] ** 2))
    if reach > 0.0:
        misfits = misfits + missed.sum(axis=1) / reach
    best = single_match(frames, misfits, 6 * len(first) - 6)
    off, most = float(np.sqrt(missed[best].mean())), max(_CHAOS * float(np.sqrt(reach)), _NOISE)
    if off > most:
        raise InconsistentDataError(
            "difference of the positions of both motions",
            f"{off:.3g} m (root mean square) in the frame that fits best",
            f"at most {most:.3g} m: motions in the same order, none of them inverted",
        )
    return assembled(frames[best], positions[best].astype(np.float64))
