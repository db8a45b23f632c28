"""Analysis of an arm, compared with the functions below and published numbers."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import (
    characteristic_length,
    condition_number,
    jacobian,
    nearest_singular_posture,
    singularity_report,
)
from robomech_ros.robots import list_robots, load_robot
from robomech_ros.rvs.model.arms.analysis import (
    arm_facts,
    drawn_ellipsoid,
    next_singularity,
    posture_facts,
    twist_arrows,
)


def test_the_fanuc_of_the_book_has_its_length_and_condition_number():
    facts = arm_facts(load_robot("fanuc_arcmate"))
    # Angeles, section 5.8.3.
    assert facts.length == pytest.approx(0.3573, abs=1e-4)
    assert facts.least_condition == pytest.approx(2.589, abs=1e-3)
    assert facts.best.condition_number == pytest.approx(facts.least_condition, rel=1e-6)


def test_limits_count_for_the_posture_to_go_to():
    chain = load_robot("panda")
    facts = arm_facts(chain)
    assert (chain.lower <= facts.best.q).all() and (facts.best.q <= chain.upper).all()
    assert facts.best.condition_number > facts.least_condition
    here = condition_number(chain, facts.best.q, length=facts.length)
    assert here == pytest.approx(facts.best.condition_number)


def test_an_arm_that_is_always_singular_has_a_size_and_no_best_posture():
    from robomech_ros.robots import chain_from_dh

    facts = arm_facts(chain_from_dh(a=[0.0] * 6, b=[0.0] * 6, alpha=[0.0] * 6))
    assert facts.length == 1.0
    assert facts.best is None or np.isfinite(facts.best.condition_number)


@pytest.mark.parametrize("robot", list_robots())
def test_the_weakest_twist_takes_the_largest_rates(robot):
    chain = load_robot(robot)
    rng = np.random.default_rng(5)
    q = np.clip(rng.uniform(-1.0, 1.0, chain.n), chain.lower, chain.upper)
    found = posture_facts(chain, q, 0.3)
    if found.report.singular:
        pytest.fail("chosen to be regular")
    scale = np.repeat((1.0, 0.3), 3)
    J = jacobian(chain, q) / scale[:, None]
    rates = np.linalg.lstsq(J, found.twists[0] / scale, rcond=1e-9)[0]
    np.testing.assert_allclose(J @ rates, found.twists[0] / scale, atol=1e-9)
    least = found.report.singular_values[found.report.rank - 1]
    assert np.linalg.norm(rates) == pytest.approx(1.0 / least, rel=1e-6)


def test_a_stretched_elbow_loses_the_way_along_the_arm():
    chain = load_robot("ur5e")
    q = np.array([0.3, -1.0, 0.0, 0.4, 0.7, 0.0])
    found = posture_facts(chain, q, 0.204)
    assert found.report.kinds == ("elbow",) and len(found.twists) == 1
    length = float(characteristic_length(chain))
    near = q + [0.0, 0.0, 0.05, 0.0, 0.0, 0.0]
    coming = next_singularity(chain, near, length)
    assert coming.kinds == ("elbow",) and coming.distance <= 0.05 + 1e-9
    assert coming.distance == nearest_singular_posture(chain, near, length=length).distance
    assert not singularity_report(chain, near, length=length).singular


@pytest.mark.parametrize("part", ["translation", "rotation"])
@pytest.mark.parametrize("robot", ["ur5e", "planar3r", "stanford"])
def test_ellipsoids_lie_at_the_tip_and_say_the_singular_values(robot, part):

    chain = load_robot(robot)
    q = chain.home()
    rows = slice(3, 6) if part == "translation" else slice(0, 3)
    values = np.linalg.svd(jacobian(chain, q)[rows], compute_uv=False)
    found = drawn_ellipsoid(chain, q, "velocity", part, 0.9)
    np.testing.assert_allclose(found.values, values, atol=1e-12)
    np.testing.assert_allclose(found.pose[:3, 3], forward_kinematics(chain, q)[:3, 3])
    assert (found.half_axes > 0.0).all() and (found.half_axes <= 0.5 * 0.9 + 1e-12).all()
    force = drawn_ellipsoid(chain, q, "force", part, 0.9)
    flat = found.values == 0.0
    np.testing.assert_allclose((force.values[::-1] * found.values)[~flat], 1.0)
    assert np.isinf(force.values[::-1][flat]).all()
    assert np.argmax(force.half_axes) == np.argmin(found.half_axes)


def test_arrows_show_motions_and_rotations_apart():
    chain = load_robot("ur5e")
    twists = np.array([[0, 0, 1, 0, 0, 0], [0, 0, 0, 2, 0, 0], [0, 1, 0, 0, 0, 3]], dtype=float)
    linear, angular = twist_arrows(forward_kinematics(chain, chain.home())[:3, 3], twists, 0.9)
    directions = np.diff(linear, axis=1)[:, 0] / (0.35 * 0.9)
    np.testing.assert_allclose(directions, [[1, 0, 0], [0, 0, 1]], atol=1e-12)
    directions = np.diff(angular, axis=1)[:, 0] / (0.35 * 0.9)
    np.testing.assert_allclose(directions, [[0, 0, 1], [0, 1, 0]], atol=1e-12)
