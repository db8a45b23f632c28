"""Ellipsoids of velocity and force, against samples of the joint rates and torques."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinetostatics import jacobian, manipulability_ellipsoid
from robomech_ros.robots import list_robots, load_robot


@pytest.mark.parametrize("rows", [slice(0, 3), slice(3, 6)])
@pytest.mark.parametrize("robot", list_robots())
def test_rates_of_norm_one_reach_the_surface_and_not_beyond(robot, rows):
    chain = load_robot(robot)
    rng = np.random.default_rng(3)
    B = jacobian(chain, rng.uniform(-2.0, 2.0, chain.n))[rows]
    axes, velocity, force = manipulability_ellipsoid(B)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) > 0.0
    rates = rng.normal(size=(chain.n, 4000))
    moved = axes.T @ B @ (rates / np.linalg.norm(rates, axis=0))
    solid = velocity > 0.0
    inside = ((moved[solid] / velocity[solid, None]) ** 2).sum(axis=0)
    assert inside.max() <= 1.0 + 1e-9 and np.abs(moved[~solid]).max(initial=0.0) < 1e-9
    # The longest direction is reached by one rate, and held by the least force of all.
    best = np.linalg.pinv(B) @ axes[:, 0]
    assert 1.0 / np.linalg.norm(best) == pytest.approx(velocity[0])
    np.testing.assert_allclose(
        np.linalg.norm(B.T @ (axes[:, solid] * force[solid]), axis=0), 1.0, rtol=1e-9
    )
    assert np.isinf(force[~solid]).all()


@pytest.mark.parametrize("joints", range(1, 8))
def test_axes_are_right_handed_and_give_the_rows_back(joints):
    B = np.random.default_rng(joints).normal(size=(3, joints))
    axes, velocity, _ = manipulability_ellipsoid(B)
    assert np.linalg.det(axes) > 0.0
    np.testing.assert_allclose(axes * velocity**2 @ axes.T, B @ B.T, atol=1e-12)


def test_one_joint_moves_along_one_line():
    axes, velocity, force = manipulability_ellipsoid([[0.0], [2.0], [0.0]])
    np.testing.assert_allclose(np.abs(axes[:, 0]), [0.0, 1.0, 0.0])
    np.testing.assert_array_equal(velocity, [2.0, 0.0, 0.0])
    np.testing.assert_array_equal(force, [0.5, np.inf, np.inf])
    np.testing.assert_array_equal(manipulability_ellipsoid(np.zeros((3, 2))).velocity, 0.0)
    thin, nothing = (manipulability_ellipsoid(np.diag([1.0, 1.0, x])) for x in (1e-11, 1e-13))
    assert thin.velocity[2] == pytest.approx(1e-11) and nothing.velocity[2] == 0.0


@pytest.mark.parametrize(
    ("rows", "error"),
    [
        (np.zeros((6, 3)), WrongSizeError),
        (np.zeros(3), WrongSizeError),
        ([[np.nan], [0.0], [0.0]], NonFiniteError),
        ("rows", BadValueError),
    ],
)
def test_what_are_no_rows_is_refused(rows, error):
    with pytest.raises(error):
        manipulability_ellipsoid(rows)
