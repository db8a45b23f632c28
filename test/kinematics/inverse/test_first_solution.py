"""One attempt from the seed."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, SeedOutsideLimitsError
from robomech_ros.kinematics import Status, forward_kinematics
from robomech_ros.kinematics.inverse.first_solution import first_solution
from robomech_ros.robots import load_robot


@pytest.mark.parametrize("name", ["puma560", "ur5e", "panda", "diestro", "scara"])
def test_a_near_seed_leads_to_a_solution_on_its_branch(name):
    arm, rng = load_robot(name), np.random.default_rng(7)
    width = np.minimum(arm.upper - arm.lower, 4.0)
    found, near = 0, 0
    for _ in range(200):
        q = arm.midrange() + 0.4 * width * rng.uniform(-1.0, 1.0, arm.n)
        seed = np.clip(q + rng.uniform(-0.05, 0.05, arm.n), arm.lower, arm.upper)
        T = forward_kinematics(arm, q)
        result = first_solution(arm, T, seed=seed)
        assert len(result) <= 1 and not result.complete
        if len(result):
            found += 1
            near += np.abs(result.q[0] - seed).max() < 0.5
            np.testing.assert_allclose(forward_kinematics(arm, result.q[0]), T, atol=1e-6)
            assert ((arm.lower <= result.q[0]) & (result.q[0] <= arm.upper)).all()
        else:
            assert result.status is Status.NOT_CONVERGED
    assert found >= 190 and near >= 180


def test_what_is_out_of_reach_is_not_converged():
    arm = load_robot("puma560")
    T = forward_kinematics(arm, arm.midrange())
    T[0, 3] += 5.0
    result = first_solution(arm, T)
    assert (result.status, len(result)) == (Status.NOT_CONVERGED, 0)
    assert "the attempt from the seed ended 4." in result.reason
    assert result.reason.endswith("other modes search farther")


def test_options_and_errors_are_those_of_inverse_kinematics():
    arm = load_robot("puma560")
    q = arm.midrange() + 0.2
    T = forward_kinematics(arm, q)
    T[:3, :3] = T[:3, :3] @ forward_kinematics(arm, q)[:3, :3]
    mask = [True, True, True, False, False, False]
    loose = first_solution(arm, T, seed=q, task_mask=mask)
    np.testing.assert_allclose(forward_kinematics(arm, loose.q[0])[:3, 3], T[:3, 3], atol=1e-6)
    with pytest.raises(SeedOutsideLimitsError):
        first_solution(arm, T, seed=q + 100.0)


@pytest.mark.parametrize("option", ["metrik", "mode", "q"])
def test_issue_12_unknown_options_are_refused_with_those_there_are(option):
    arm = load_robot("puma560")
    with pytest.raises(BadValueError, match=f"option is '{option}', expected one of .*metric"):
        first_solution(arm, np.eye(4), **{option: "l2"})
    with pytest.raises(BadValueError, match="max_solutions"):
        first_solution(arm, np.eye(4), max_solutions=0)
    with pytest.raises(BadValueError, match="include_windings"):
        first_solution(arm, np.eye(4), include_windings="all")
