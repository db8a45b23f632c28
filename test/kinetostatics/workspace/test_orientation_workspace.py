"""Orientations that can be taken at a point."""

import math

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import orientation_workspace
from robomech_ros.robots import load_robot

PUMA = load_robot("puma560")


def test_an_orthogonal_wrist_takes_every_orientation_where_its_centre_can_be():
    """The tip of this robot is the centre of its wrist: all or nothing, limits aside."""
    inside = orientation_workspace(PUMA, (0.4, 0.2, 0.1), samples=512, respect_limits=False)
    assert inside.share == 1.0
    assert (inside.solution_count == 8).mean() > 0.99
    assert orientation_workspace(PUMA, (2.0, 0.0, 0.0), samples=64).share == 0.0


def test_each_sample_is_what_a_single_call_says():
    arm = load_robot("irb120")
    point = forward_kinematics(arm, np.full(6, 0.3))[:3, 3]
    found = orientation_workspace(arm, point, samples=40)
    assert 0.0 < found.share < 1.0
    for rotation, count in zip(found.rotations, found.solution_count, strict=True):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = rotation, point
        assert len(inverse_kinematics(arm, T)) == count
    assert len(found.approach_directions) == found.reachable.sum()


def test_samples_are_even():
    """The mean of a function over the samples is that over all rotations."""
    rotations = orientation_workspace(PUMA, (2.0, 0.0, 0.0), samples=4096).rotations
    assert np.abs(rotations.mean(axis=0)).max() < 2e-3
    angle = np.arccos(np.clip((np.trace(rotations, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0))
    # The density of the angle of even rotations is (1 - cos) / pi.
    assert angle.mean() == pytest.approx(math.pi / 2.0 + 2.0 / math.pi, abs=5e-3)


def test_bad_input_is_refused():
    for error, text, arguments in (
        (BadValueError, "number of joints is 3", (load_robot("planar3r"), (1.0, 0.0, 0.0))),
        (WrongSizeError, "position", (PUMA, (1.0, 0.0))),
        (NonFiniteError, "position", (PUMA, (1.0, math.inf, 0.0))),
        (BadValueError, "SerialChain", ("puma560", (1.0, 0.0, 0.0))),
    ):
        with pytest.raises(error, match=text):
            orientation_workspace(*arguments)
    for samples in (0, 1.5, True, 10**9):
        with pytest.raises(BadValueError, match="number of orientations"):
            orientation_workspace(PUMA, (0.4, 0.2, 0.1), samples=samples)
