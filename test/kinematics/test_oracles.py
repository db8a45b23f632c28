"""Independent solvers of general arms agree with the fast one."""

import numpy as np
import pytest
from general_arms import general_arm, random_postures

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.oracles import solve_bivariate, solve_univariate
from robomech_ros.robots import load_robot

ARMS = ("general6r", "manocha-code", "diestro", "random-0", "random-1", "random-2")


@pytest.mark.parametrize("name", ARMS)
def test_eigenvalues_give_the_same_solutions(apart, name):
    chain = general_arm(name)
    for T in forward_kinematics(chain, random_postures(12, 1)):
        ours = inverse_kinematics(chain, T, respect_limits=False)
        theirs = solve_univariate(chain, T)
        assert len(theirs) == len(ours)
        for q in theirs:
            assert apart(chain, ours.q, q).min() < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("name", ("diestro", "random-0"))
def test_contours_give_the_same_solutions(apart, name):
    chain = general_arm(name)
    for T in forward_kinematics(chain, random_postures(2, 2)):
        ours = inverse_kinematics(chain, T, respect_limits=False)
        crossings = solve_bivariate(chain, T, steps=120)
        assert len(crossings) == len(ours)
        for crossing in crossings:
            assert apart(chain, ours.q, crossing.q).min() < 1e-7
            assert crossing.condition >= 1.0 and 0.0 <= crossing.crossing <= np.pi / 2


def test_only_six_revolute_joints():
    with pytest.raises(BadValueError, match="six revolute"):
        solve_univariate(load_robot("panda"), np.eye(4))
