"""Jacobians and what is made of them where joints follow others, by finite differences."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import (
    bias_acceleration,
    condition_number,
    condition_number_gradient,
    jacobian,
    jacobian_rate,
    joint_rates,
    manipulability,
    manipulability_gradient,
    nearest_singular_posture,
    planar_rows,
    point_jacobian,
    reach_limits,
    singularity_free,
    singularity_report,
    workspace_boundary,
)
from test.coupled_robots import coupled

STEP = 1e-6


@pytest.fixture(params=["palletizer", "coupled_finger", "hollow_wrist"])
def chain(request):
    return coupled(request.param)


@pytest.fixture
def state(chain):
    random = np.random.default_rng(2)
    q = random.uniform(np.maximum(chain.lower, 0.1), np.minimum(chain.upper, 0.9))
    return q, random.normal(size=chain.n)


def differences(function, q):
    """Central differences of a function by the drives, on the last axis."""
    steps = STEP * np.eye(len(q))
    return np.stack([(function(q + h) - function(q - h)) / (2 * STEP) for h in steps], axis=-1)


def test_the_jacobian_is_that_of_all_joints_through_the_coupling(chain, state):
    q, qd = state
    J = jacobian(chain, q)
    all_joints = jacobian(chain.uncoupled, chain.joint_values(q))
    np.testing.assert_allclose(J, all_joints @ chain.coupling.matrix, atol=1e-14)
    point = [0.1, -0.2, 0.3]
    tips = differences(lambda at: (forward_kinematics(chain, at) @ [*point, 1.0])[:3], q)
    np.testing.assert_allclose(point_jacobian(chain, q, point)[3:], tips, atol=1e-8)
    np.testing.assert_allclose(joint_rates(chain, q, J @ qd), qd, atol=1e-9)


def test_rates_and_gradients(chain, state):
    q, qd = state
    rate = differences(lambda at: jacobian(chain, at), q) @ qd
    np.testing.assert_allclose(jacobian_rate(chain, q, qd), rate, atol=1e-8)
    np.testing.assert_allclose(bias_acceleration(chain, q, qd), rate @ qd, atol=1e-7)
    for value, gradient in (
        (manipulability, manipulability_gradient),
        (condition_number, condition_number_gradient),
    ):
        expected = differences(lambda at, value=value: value(chain, at), q)
        np.testing.assert_allclose(gradient(chain, q), expected, rtol=1e-5, atol=1e-6)


def test_singular_values_are_those_of_the_drives(chain, state):
    q, _ = state
    found = singularity_report(chain, q, length=1.0).singular_values
    expected = np.linalg.svd(jacobian(chain, q), compute_uv=False)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_the_nearest_singular_posture_of_a_palletizer_is_stretched_or_over_its_axis():
    chain = coupled("palletizer")
    found = nearest_singular_posture(chain, [0.3, 0.4, 0.9, 0.2])
    assert np.linalg.svd(jacobian(chain, found.q), compute_uv=False)[-1] < 1e-9
    _, rear, fore, _ = found.q
    over = np.hypot(*forward_kinematics(chain, found.q)[:2, 3])
    assert min(abs(np.cos(fore - rear)), over) < 1e-6


def test_reach_is_that_of_many_postures(chain):
    q = np.random.default_rng(3).uniform(chain.lower, chain.upper, (20_000, chain.n))
    away = forward_kinematics(chain, q)[:, :3, 3] - chain.packed[0, 10:13]
    distances = np.linalg.norm(away, axis=1)
    least, most = reach_limits(chain)
    assert distances.min() - 0.2 < least < distances.min() + 1e-9
    assert distances.max() - 1e-9 < most < distances.max() + 0.1


def test_what_is_read_from_axes_is_refused():
    chain = coupled("palletizer")
    with pytest.raises(
        BadValueError, match="mimic joints rear_back, level.*nearest_singular_posture"
    ):
        singularity_free(chain)
    with pytest.raises(BadValueError, match="mimic joints rear_back, level.*reach_map"):
        workspace_boundary(chain)
    with pytest.raises(BadValueError, match="a planar one: joint 'rear'"):
        planar_rows(chain)
