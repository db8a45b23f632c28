"""The best conditioned posture inside the limits, against other searches."""

import numpy as np
import pytest
from scipy.optimize import minimize

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.posture_samples import sample_postures
from robomech_ros.kinetostatics import (
    best_conditioned_posture,
    characteristic_length,
    condition_number,
)
from robomech_ros.robots import load_robot


@pytest.mark.parametrize(
    "robot",
    [
        "general6r",
        "planar3r",
        "ur5e",
        pytest.param("m1013", marks=pytest.mark.long),
        pytest.param("puma560", marks=pytest.mark.long),
    ],
)
def test_is_the_least_of_all_where_that_is_inside_the_limits(robot):
    chain = load_robot(robot)
    everywhere = characteristic_length(chain).condition_number
    assert best_conditioned_posture(chain).condition_number == pytest.approx(everywhere, rel=1e-6)


@pytest.mark.parametrize("robot", ["panda", "scara", "vx300", "stanford"])
def test_is_inside_the_limits_and_no_sample_improved_is_better(robot):
    chain = load_robot(robot)
    everywhere = characteristic_length(chain)
    length = float(everywhere)
    best = best_conditioned_posture(chain, length=length)
    assert (chain.lower <= best.q).all() and (best.q <= chain.upper).all()
    assert condition_number(chain, best.q, length=length) == pytest.approx(
        best.condition_number, rel=1e-12
    )
    assert best.condition_number > everywhere.condition_number

    def condition(x):
        return condition_number(chain, np.clip(x, chain.lower, chain.upper), length=length)

    samples = sample_postures(chain, 20000)
    starts = samples[np.argsort(condition_number(chain, samples, length=length))[:3]]
    others = [minimize(condition, q, method="Nelder-Mead").fun for q in starts]
    assert best.condition_number <= min(others) * (1.0 + 1e-4)


def test_what_is_no_chain_or_no_length_is_refused():
    with pytest.raises(BadValueError, match="chain"):
        best_conditioned_posture("puma560")
    with pytest.raises(BadValueError, match="length is -1.0, expected a length from 1e-9"):
        best_conditioned_posture(load_robot("puma560"), length=-1.0)
