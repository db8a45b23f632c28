"""Self-motions: traced whole, their parts inside the limits, and the best posture on them."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import (
    Status,
    branch_path,
    forward_kinematics,
    inverse_kinematics,
    optimal_posture,
    self_motion,
)
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, load_robot

ARMS = ["iiwa14", "panda", "gen3"]


def random_postures(chain, count, seed):
    rng = np.random.default_rng(seed)
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    return rng.uniform(lower, upper, (count, chain.n))


def inside(chain, q):
    """Which postures have all joints inside their limits, in some winding."""
    turns = 2 * np.pi * np.arange(-2, 3)[:, None, None]
    wound = np.asarray(q)[None] + turns
    return ((wound >= chain.lower) & (wound <= chain.upper)).any(axis=0).all(axis=1)


@pytest.mark.parametrize("name", ARMS)
def test_the_tip_stays(name, pose_errors):
    chain = load_robot(name)
    for posture in random_postures(chain, 4, 1):
        T = forward_kinematics(chain, posture)
        motion = self_motion(chain, T)
        assert motion.branches and motion.chain is chain
        for branch in motion.branches:
            assert pose_errors(chain, T, branch.q).max() < 2e-9
            assert (np.diff(branch.parameter) > 0).all()
            assert np.abs(np.diff(branch.q, axis=0)).max() <= 0.3
        closed = [branch for branch in motion.branches if branch.closed]
        for branch in closed:
            turned = np.remainder(branch.q[-1] - branch.q[0] + 1, 2 * np.pi) - 1
            assert np.abs(turned).max() < 1e-6


@pytest.mark.parametrize("name", ARMS)
def test_every_solution_lies_on_an_interval(name, apart):
    chain = load_robot(name)
    for posture in random_postures(chain, 3, 2):
        T = forward_kinematics(chain, posture)
        motion = self_motion(chain, T)
        found = np.vstack((posture, inverse_kinematics(chain, T).q))
        for q in found:
            gaps = [apart(chain, branch.q, q).min() for branch in motion.branches]
            branch = motion.branches[int(np.argmin(gaps))]
            assert min(gaps) < 0.3
            value = branch.parameter[apart(chain, branch.q, q).argmin()]
            low, high = branch.intervals[:, 0] - 0.1, branch.intervals[:, 1] + 0.1
            assert ((low <= value) & (value <= high)).any()


@pytest.mark.parametrize("name", ARMS)
def test_intervals_are_where_limits_are_kept(name):
    chain = load_robot(name)
    edges = 0
    for posture in random_postures(chain, 4, 3):
        motion = self_motion(chain, forward_kinematics(chain, posture))
        for branch in motion.branches:
            within = np.zeros(len(branch.q), bool)
            for low, high in branch.intervals:
                within |= (branch.parameter >= low - 1e-9) & (branch.parameter <= high + 1e-9)
                edges += 1
            np.testing.assert_array_equal(within, inside(chain, branch.q))
        assert motion.feasible == pytest.approx(
            sum(
                (branch.intervals[:, 1] - branch.intervals[:, 0]).sum()
                for branch in motion.branches
            )
        )
    assert edges > 10


def test_an_arm_with_shoulder_and_wrist_has_eight_closed_branches():
    chain = load_robot("iiwa14")
    T = forward_kinematics(chain, [0.3, 0.6, -0.4, -1.3, 0.5, 0.9, 0.1])
    motion = self_motion(chain, T)
    assert motion.parameter_name == "the arm angle"
    assert len(motion.branches) == 8 and all(branch.closed for branch in motion.branches)
    first = [branch.parameter[0] for branch in motion.branches]
    np.testing.assert_allclose(first, -np.pi)


def test_the_arm_angle_is_that_of_the_elbow():
    """Shoulder, elbow and wrist of the KUKA iiwa at a traced posture, against the parameter."""
    chain = load_robot("iiwa14")
    q = np.array([0.3, 0.6, -0.4, -1.3, 0.5, 0.9, 0.1])
    motion = self_motion(chain, forward_kinematics(chain, q))
    for branch in motion.branches:
        for value, posture in list(zip(branch.parameter, branch.q, strict=True))[::15]:
            shoulder = np.array([0, 0, 0.36])
            elbow = forward_kinematics(chain.with_tip("link_4"), posture[:4])[:3, 3]
            wrist = forward_kinematics(chain.with_tip("link_6"), posture[:6])[:3, 3]
            along = (wrist - shoulder) / np.linalg.norm(wrist - shoulder)
            side = (elbow - shoulder) - along * ((elbow - shoulder) @ along)
            zero = np.array([0, 0, 1]) - along * along[2]
            angle = np.arctan2(side @ np.cross(along, zero), side @ zero)
            assert np.cos(angle - value) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("criterion", ["limit_margin", "manipulability"])
@pytest.mark.parametrize("name", ARMS)
def test_the_best_posture_is_best(name, criterion, pose_errors):
    chain = load_robot(name)
    for posture in random_postures(chain, 3, 4):
        T = forward_kinematics(chain, posture)
        best = optimal_posture(chain, T, criterion=criterion)
        assert best.status is Status.SUCCESS and len(best) == 1
        assert pose_errors(chain, T, best.q).max() < 2e-9
        assert best.limit_margin[0] >= -1e-9
        others = np.vstack([inverse_kinematics(chain, T, seed=s).q
                            for s in np.clip(random_postures(chain, 10, 5), -2.9, 2.9)
                            if inside(chain, s[None])[0]])  # fmt: skip
        if criterion == "limit_margin":
            worth = np.minimum(others - chain.lower, chain.upper - others).min(axis=1)
            mine = best.limit_margin[0]
        else:
            worth, mine = (
                np.sqrt(np.linalg.det(J @ np.swapaxes(J, 1, 2)))
                for J in (jacobian(chain, others), jacobian(chain, best.q))
            )
        assert np.max(mine) >= worth.max() - 1e-6
        assert f"best by {criterion}" in best.reason
        same = inverse_kinematics(chain, T, seed=best.q[0], max_solutions=1)
        assert best.branches == same.branches and best.continuum


@pytest.mark.parametrize("last", [False, True])
def test_a_long_slide_is_searched_where_the_arm_reaches(last, pose_errors):
    """Beyond the arm's length from the zero of a slide nothing was found."""
    a, b = [0, 0.4318, 0.0203, 0, 0, 0], [0, 0, 0.15, 0.4318, 0, 0.1]
    alpha, q = [np.pi / 2 * one for one in (1, 0, -1, 1, -1, 0.4)], [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]
    limits, at = [[-3.1, 3.1]] * 6, 6 if last else 0
    for values, more in ((a, 0), (b, 0), (alpha, 0.5), (limits, [-9.0, 9.0]), (q, 8.0)):
        values.insert(at, more)
    types = "RRRRRRP" if last else "PRRRRRR"
    chain = chain_from_dh(a, b, alpha, types=types, limits=limits)
    T = forward_kinematics(chain, q)
    assert self_motion(chain, T).parameter_name == f"joint 'joint_{at + 1}'"
    best = optimal_posture(chain, T)
    assert "best by" in best.reason and pose_errors(chain, T, best.q).max() < 2e-9


def test_out_of_reach_there_is_no_motion():
    chain = load_robot("panda")
    T = forward_kinematics(chain, chain.midrange())
    T[0, 3] += 5.0
    assert self_motion(chain, T).branches == ()
    assert optimal_posture(chain, T).status is Status.OUT_OF_REACH


def test_bad_requests_are_refused():
    panda, puma = load_robot("panda"), load_robot("puma560")
    T = forward_kinematics(panda, panda.midrange())
    with pytest.raises(BadValueError, match="number of joints"):
        self_motion(puma, T)
    for criterion in ("speed", None, ["limit_margin"]):
        with pytest.raises(BadValueError, match="one of limit_margin, manipulability"):
            optimal_posture(panda, T, criterion=criterion)


def test_a_redundant_arm_of_any_geometry(pose_errors, apart):
    chain = load_robot("general7r")
    q = np.array([0.3, -0.5, 0.7, 0.9, -0.4, 0.6, 0.2])
    T = forward_kinematics(chain, q)
    motion = self_motion(chain, T)
    assert motion.branches and "joint_7" in motion.parameter_name
    for branch in motion.branches:
        assert pose_errors(chain, T, branch.q).max() < 1e-9
    for posture in (q, *inverse_kinematics(chain, T, seed=q).q):
        assert min(apart(chain, branch.q, posture).min() for branch in motion.branches) < 0.3
    best = optimal_posture(chain, T)
    assert best.status is Status.SUCCESS and pose_errors(chain, T, best.q).max() < 1e-9
    margin = np.minimum(best.q - chain.lower, chain.upper - best.q).min()
    assert margin >= np.minimum(q - chain.lower, chain.upper - q).min()


def test_a_redundant_arm_of_which_no_six_joints_move_in_all_directions():
    """Axes 3 to 6 are parallel: either six joints have all of these, one too many."""
    a, b = [0.1, 0.3, 0.3, 0.2, 0.2, 0.1, 0.1], [0.3, 0.1, 0, 0.1, 0, 0.1, 0.2]
    chain = chain_from_dh(a, b, [1.4, 1.2, 0, 0, 0, 1.1, 0.3])
    T = forward_kinematics(chain, [0.3, -0.5, 0.7, 0.9, -0.4, 0.6, 0.2])
    with pytest.raises(BadValueError, match="six joints move in all directions"):
        self_motion(chain, T)


@pytest.mark.parametrize("function", [self_motion, branch_path])
def test_what_is_no_chain_is_named(function):
    with pytest.raises(BadValueError, match="chain is None, expected a SerialChain"):
        function(None, np.eye(4))
