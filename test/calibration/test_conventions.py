"""Rotations alone exclude inverted poses: soundly, and in ordinary calibrations."""

import numpy as np
import pytest
from hand_eye_cells import KINDS, samples

from robomech_ros.calibration.conventions import rotations_exclude_inverse
from robomech_ros.calibration.initial_guess import consistent_samples, invert_rows, pack_poses
from robomech_ros.calibration.maximum_likelihood import Fit


def excluded(A, S, inverted):
    A, S = pack_poses(A), pack_poses(S)
    A = invert_rows(A) if inverted else A
    consistent = consistent_samples(A, S)
    return rotations_exclude_inverse(Fit.from_guess(A, S, consistent, 0, None), consistent)


@pytest.mark.parametrize("noise", [0.0, 1e-3, 0.03, 0.3])
@pytest.mark.parametrize("n", [4, 6, 20])
def test_the_right_convention_is_never_excluded(n, noise):
    rng = np.random.default_rng(21)
    for kind in KINDS * 10:
        A, S, _, _ = samples(rng, n, kind, camera=(noise, 1e-3), robot=(0.3 * noise, 1e-3))
        assert not excluded(A, S, inverted=True)


@pytest.mark.parametrize("n", [10, 20])
def test_the_inverse_of_ordinary_samples_is_excluded(n):
    rng = np.random.default_rng(22)
    for _ in range(20):
        A, S, _, _ = samples(rng, n, camera=(np.radians(0.5), 2e-3))
        assert excluded(A, S, inverted=False)


def test_rotations_about_parallel_axes_exclude_nothing():
    rng = np.random.default_rng(23)
    A, S, _, _ = samples(rng, 20, camera=(np.radians(0.1), 5e-4))
    A[:, :2, 2], A[:, 2, :2], A[:, 2, 2] = 0.0, 0.0, 1.0
    angles = rng.uniform(-1.5, 1.5, 20)
    c, s = np.cos(angles), np.sin(angles)
    A[:, 0, 0], A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = c, -s, s, c
    S[:, :3, :3] = np.swapaxes(A[:, :3, :3], 1, 2)
    assert not excluded(A, S, inverted=False)
    assert not excluded(A, S, inverted=True)
