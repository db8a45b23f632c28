"""Independent solvers of general arms agree with the fast one."""

import json
from pathlib import Path

import numpy as np
import pytest
from general_arms import general_arm, random_postures

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.equations import PROCEDURES
from robomech_ros.kinematics.oracles import solve_bivariate, solve_univariate
from robomech_ros.robots import load_robot

ARMS = ("general6r", "manocha-code", "diestro", "random-0", "random-1", "random-2")


@pytest.mark.parametrize("name", ARMS)
def test_eigenvalues_give_the_same_solutions(apart, name):
    chain = general_arm(name)
    for T in forward_kinematics(chain, random_postures(5, 1)):
        ours = inverse_kinematics(chain, T, respect_limits=False)
        theirs = solve_univariate(chain, T)
        assert len(theirs) == len(ours)
        for q in theirs:
            assert apart(chain, ours.q, q).min() < 1e-7


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


def test_the_other_procedure_has_a_name():
    chain = general_arm("random-0")
    T = forward_kinematics(chain, random_postures(1, 4)[0])
    one, other = (solve_univariate(chain, T, procedure=name) for name in PROCEDURES)
    np.testing.assert_allclose(one.q, other.q, atol=1e-9)
    with pytest.raises(BadValueError, match="raghavan-roth, li-woernle-hiller"):
        solve_univariate(chain, T, procedure="li")


def test_only_six_revolute_joints():
    with pytest.raises(BadValueError, match="six revolute"):
        solve_univariate(load_robot("panda"), np.eye(4))


def test_issue_12_contours_that_touch_give_one_posture(apart):
    """They gave 31 for the 8 postures of this pose, of which two are singular."""
    golden = Path(__file__).parents[1] / "data" / "golden" / "ik6r_diestro_recalled_pose.json"
    pose = json.loads(golden.read_text())
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = pose["R"], pose["p"]
    chain = load_robot("diestro")
    ours = inverse_kinematics(chain, T, respect_limits=False)
    crossings = solve_bivariate(chain, T, steps=120)
    assert len(crossings) == len(ours) == 8
    for crossing in crossings:
        assert apart(chain, ours.q, crossing.q).min() < 2e-4


@pytest.mark.parametrize("name", ("ur5e", "xarm6", "crx10ia", "jaco2", "irb120", *ARMS))
def test_issue_12_eigenvalues_say_whether_postures_are_missing(name):
    chain = load_robot(name) if name not in ARMS else general_arm(name)
    said = 0
    for T in forward_kinematics(chain, random_postures(4, 3)):
        ours = inverse_kinematics(chain, T, respect_limits=False)
        theirs = solve_univariate(chain, T)
        assert bool(theirs.reason) != theirs.complete
        assert not theirs.complete or len(theirs) == len(ours)
        assert np.asarray(theirs).shape == (len(theirs), 6)
        said += theirs.complete
    # Before another joint was hidden where joint 3 cannot be, on none of the built arms.
    assert said >= 3


@pytest.mark.parametrize("solve", (solve_univariate, solve_bivariate))
@pytest.mark.parametrize(
    ("T", "error"),
    [
        (np.eye(3), WrongSizeError),
        (np.full((4, 4), np.nan), NonFiniteError),
        (np.zeros((4, 4)), BadValueError),
        (None, BadValueError),
        ("pose", BadValueError),
    ],
)
def test_issue_12_wrong_poses_raise_our_errors(solve, T, error):
    with pytest.raises(error):
        solve(load_robot("diestro"), T)


@pytest.mark.parametrize("steps", (0, 7, 10.5, None, float("nan"), float("inf")))
def test_issue_12_too_few_steps_are_refused(steps):
    with pytest.raises(BadValueError, match="steps"):
        solve_bivariate(load_robot("diestro"), np.eye(4), steps=steps)
