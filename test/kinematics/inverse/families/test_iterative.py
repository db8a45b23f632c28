"""The iterative solver: chains without a closed form, limits, determinism, hopeless targets."""

import time

import numpy as np
import pytest

from robomech_ros._kernels.inverse.iterative import layout as iterative_layout
from robomech_ros.kinematics import Status, forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.inverse.families.iterative import (
    ITERATIVE_RESTARTS,
    SearchGoal,
    iterative_data,
    task_data,
)
from robomech_ros.kinematics.inverse.families.iterative_search import (
    REACH_ATTEMPTS,
    iterative_search,
    least_orientation_error,
)
from robomech_ros.kinematics.inverse.request.task import FULL_TASK
from robomech_ros.kinematics.inverse.result.reach import REACH_STARTS, reach_gap
from robomech_ros.robots import chain_from_dh, load_robot

REACHABLE = 1000


def random_postures(chain, count, seed):
    rng = np.random.default_rng(seed)
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    return rng.uniform(lower, upper, (count, chain.n))


def solved(chain, q):
    """How many targets of reachable postures get a solution, all of which must hold."""
    data = iterative_data(chain, SearchGoal(wanted=1))
    seed = chain.midrange()
    found = 0
    for T in forward_kinematics(chain, q):
        search = iterative_search(data, T, seed)
        if len(search.q):
            found += 1
            error = np.abs(forward_kinematics(chain, search.q) - T).max()
            assert error < 1e-8
            assert search.attempts <= data[iterative_layout.RESTARTS]
    return found


@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("panda", 0.999),
        ("general6r", 0.999),
        ("fanuc_arcmate", 0.999),
        ("diestro", 0.999),
        ("scara", 1.0),
        ("planar3r", 1.0),
    ],
)
def test_reachable_targets_are_reached(name, least):
    chain = load_robot(name)
    assert solved(chain, random_postures(chain, REACHABLE, 1)) >= least * REACHABLE


@pytest.mark.parametrize("name", ["ik6r_manocha_canny_16", "ik6r_manocha_code_ex2"])
def test_general_arms_of_the_literature(golden, name):
    case = golden(name)
    chain = chain_from_golden(case)
    assert solved(chain, random_postures(chain, 300, 2)) == 300


def chain_from_golden(case):
    return chain_from_dh(case["a"], case["b"], case["alpha"])


@pytest.mark.parametrize("name", ["panda", "scara", "planar3r"])
def test_solutions_are_inside_the_limits(name):
    chain = load_robot(name)
    for T in forward_kinematics(chain, random_postures(chain, 100, 3)):
        q = inverse_kinematics(chain, T).q
        assert len(q)
        assert (q >= chain.lower).all() and (q <= chain.upper).all()


def test_limits_are_bounds_of_the_search_itself():
    """A target on the limit of a joint, from a seed that pulls through the limit."""
    chain = load_robot("panda")
    rng = np.random.default_rng(4)
    for q in random_postures(chain, 100, 4):
        joint = rng.integers(chain.n)
        q[joint] = rng.choice([chain.lower[joint], chain.upper[joint]])
        T = forward_kinematics(chain, q)
        found = inverse_kinematics(chain, T).q
        assert len(found) and (found >= chain.lower).all() and (found <= chain.upper).all()


@pytest.mark.parametrize("name", ["panda", "general6r", "scara"])
def test_same_request_same_bytes(name):
    chain = load_robot(name)
    for T in forward_kinematics(chain, random_postures(chain, 20, 5)):
        one, other = inverse_kinematics(chain, T), inverse_kinematics(chain, T.copy())
        assert one.q.tobytes() == other.q.tobytes() and one.reason == other.reason


def test_the_solution_at_the_seed_comes_first():
    # Of four parallel axes between others no six neighbouring joints move in all directions.
    a, b = [0.1, 0.3, 0.3, 0.2, 0.2, 0.1, 0.1], [0.3, 0.1, 0, 0.1, 0, 0.1, 0.2]
    chain = chain_from_dh(a, b, [1.4, 1.2, 0, 0, 0, 1.1, 0.3])
    for q in random_postures(chain, 50, 6):
        result = inverse_kinematics(chain, forward_kinematics(chain, q), seed=q)
        assert np.abs(result.q[0] - q).max() < 1e-9
        assert not result.complete and result.family == "iterative"


def test_several_postures_of_a_redundant_arm():
    chain = load_robot("panda")
    T = forward_kinematics(chain, chain.midrange() + 0.1)
    q = inverse_kinematics(chain, T).q
    assert len(q) >= 4
    distance = np.abs(q[:, None] - q[None]).max(axis=2) + 9.0 * np.eye(len(q))
    assert distance.min() > 0.05


@pytest.mark.parametrize("name", ["general6r", "fanuc_arcmate", "diestro"])
def test_most_solutions_of_a_general_arm_are_found(search_everywhere, apart, name):
    chain = load_robot(name)
    expected = found = 0
    targets = forward_kinematics(chain, random_postures(chain, 8, 7))
    for T, postures in zip(targets, search_everywhere(chain, targets), strict=True):
        ours = inverse_kinematics(chain, T, respect_limits=False).q
        expected += len(postures)
        found += (apart(chain, ours, postures[:, None]).min(axis=1, initial=9.0) < 1e-5).sum()
    assert found >= 0.95 * expected


@pytest.mark.parametrize("name", ["panda", "general6r", "scara", "planar3r"])
def test_hopeless_targets_end_after_one_search_inside_and_one_beyond_the_limits(
    counted_search, name
):
    chain = load_robot(name)
    T = np.eye(4)
    T[:3, 3] = [9.0, 0.0, 0.0]
    result = inverse_kinematics(chain, T)
    assert counted_search.attempts <= 2 * ITERATIVE_RESTARTS
    assert 0 < counted_search.starts <= 2 * REACH_STARTS
    assert not len(result) and result.status.name == "OUT_OF_REACH"


def test_time_out_is_honoured():
    chain = load_robot("panda")
    data = iterative_data(chain)
    T = np.eye(4)
    T[:3, 3] = [9.0, 0.0, 0.0]
    search = iterative_search(data, T, chain.midrange(), timeout=0.0)
    assert (
        search.timed_out and not len(search.q) and search.attempts < data[iterative_layout.RESTARTS]
    )
    assert search.position_error > 1.0


def test_chunks_of_a_timed_search_find_the_same():
    chain = load_robot("general6r")
    data = iterative_data(chain)
    for T in forward_kinematics(chain, random_postures(chain, 10, 8)):
        whole = iterative_search(data, T, chain.midrange())
        parts = iterative_search(data, T, chain.midrange(), timeout=60.0)
        assert whole.q.tobytes() == parts.q.tobytes()


@pytest.mark.parametrize(
    "mask",
    [
        (True, True, True, False, False, False),
        (True, True, True, True, True, False),
        (True, True, True, False, False, True),
        (False, False, False, True, True, True),
        (True, False, True, False, True, False),
    ],
)
@pytest.mark.parametrize("name", ["panda", "puma560", "scara"])
def test_masked_components_of_the_task_hold(name, mask):
    """Components are those of the error's rotation vector and of the position, in the base."""
    from scipy.spatial.transform import Rotation

    chain = load_robot(name)
    data = iterative_data(chain, SearchGoal(task=mask, wanted=3))
    for T in forward_kinematics(chain, random_postures(chain, 30, 9)):
        search = iterative_search(data, T, chain.midrange())
        assert len(search.q)
        for pose in forward_kinematics(chain, search.q):
            turn = Rotation.from_matrix(T[:3, :3] @ pose[:3, :3].T).as_rotvec()
            error = np.r_[T[:3, 3] - pose[:3, 3], turn]
            assert np.abs(error[np.array(mask)]).max() < 1e-8


def test_singular_targets_of_chains_without_closed_form():
    """Stretched and folded arms, where Newton's method only creeps."""
    planar, scara = load_robot("planar3r"), load_robot("scara")
    rng = np.random.default_rng(10)
    for chain in (planar, scara):
        for q in random_postures(chain, 100, 11):
            q[1] = 0.0
            if chain is planar:
                q[2] = rng.choice([0.0, q[2]])
            T = forward_kinematics(chain, q)
            search = iterative_search(iterative_data(chain), T, chain.midrange())
            assert len(search.q), q
            assert np.abs(forward_kinematics(chain, search.q) - T).max() < 1e-8


def test_unlimited_prismatic_joints_and_turns():
    chain = chain_from_dh(
        [0.2, 0.3, 0.0, 0.1, 0.2],
        [0.1, 0.0, 0.2, 0.1, 0.0],
        [0.5, -1.0, 1.2, 0.3, 0.7],
        types=[0, 1, 0, 1, 0],
    )
    rng = np.random.default_rng(12)
    for q in rng.uniform(-1.0, 1.0, (100, 5)):
        T = forward_kinematics(chain, q)
        search = iterative_search(iterative_data(chain), T, np.zeros(5))
        assert len(search.q)
        assert np.abs(forward_kinematics(chain, search.q) - T).max() < 1e-8


def test_one_joint():
    chain = chain_from_dh([0.5], [0.1], [0.3])
    T = forward_kinematics(chain, [0.7])
    search = iterative_search(iterative_data(chain), T, np.zeros(1))
    assert np.abs(search.q - 0.7).max() < 1e-8


def test_a_loose_tolerance_is_enough():
    """A target beyond the reach by less than the tolerance."""
    chain = load_robot("planar3r")
    T = forward_kinematics(chain, np.zeros(3))
    T[0, 3] += 5e-4
    assert not len(inverse_kinematics(chain, T))
    near = inverse_kinematics(chain, T, position_tolerance=1e-3, orientation_tolerance=1e-3)
    assert len(near) and near.position_error.max() < 1e-3


def ten_joints():
    """Ten joints, two of them slides, with limits."""
    rng = np.random.default_rng(0)
    types = "RPRRRPRRRR"
    limits = np.array([[-0.3, 0.3] if kind == "P" else [-2.0, 2.0] for kind in types])
    a, b, alpha = rng.uniform(0.05, 0.3, 10), rng.uniform(-0.2, 0.2, 10), rng.uniform(-1.5, 1.5, 10)
    return chain_from_dh(a, b, alpha, types=types, limits=limits)


def test_ten_mixed_joints_inside_their_limits():
    chain = ten_joints()
    for T in forward_kinematics(chain, random_postures(chain, 200, 11)):
        result = inverse_kinematics(chain, T, max_solutions=1)
        assert result.status is Status.SUCCESS and len(result) == 1
        assert (result.q >= chain.lower).all() and (result.q <= chain.upper).all()
        assert result.position_error[0] < 1e-9 and result.orientation_error[0] < 1e-9


@pytest.mark.parametrize(("joints", "attempts"), [(6, 8), (10, 8), (40, 3), (64, 1)])
def test_the_longer_the_chain_the_more_often_a_search_looks_at_the_clock(joints, attempts):
    """The work of an attempt grows with the cube of the joints: some ms for a hundred."""
    a = np.full(joints, 0.1)
    chain = chain_from_dh(a, 0.0 * a, np.where(np.arange(joints) % 2, 1.5, -1.5))
    T = np.eye(4)
    T[:3, 3] = 2.0 * joints
    search = iterative_search(iterative_data(chain), T, np.zeros(joints), timeout=1e-9)
    assert search.timed_out and search.attempts == attempts


def test_no_time_is_left_for_a_reason():
    rng = np.random.default_rng(3)
    chain = chain_from_dh(rng.uniform(0.1, 0.3, 10), np.zeros(10), rng.uniform(-1.5, 1.5, 10))
    near, far = forward_kinematics(chain, np.full((2, 10), 0.1))
    far[:3, 3] += 20.0
    near[:3, :3] = near[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    assert np.isnan(reach_gap(chain, far, deadline=time.monotonic())).all()
    data, target = task_data(
        chain, near, SearchGoal(task=FULL_TASK, respect_limits=False, wanted=1)
    )
    assert np.isnan(least_orientation_error(data, target, np.full(10, 0.1), deadline=0.0))
    assert reach_gap(chain, far, deadline=time.monotonic() + 60.0) == pytest.approx(
        reach_gap(chain, far), rel=1e-12, nan_ok=True
    )


@pytest.mark.parametrize("name", ["ten", "general6r", "panda", "gen3", "iiwa14", "vx300"])
def test_a_timeout_is_kept_to_a_few_looks_at_the_clock(counted_search, name):
    chain = ten_joints() if name == "ten" else load_robot(name)
    T = forward_kinematics(chain, random_postures(chain, 20, 12))
    T[:, :3, 3] *= 1.5
    T[:, :3, :3] = T[::-1, :3, :3]
    for timeout in (1, 5, 20):
        for target in T:
            counted_search.forget()
            inverse_kinematics(chain, target, timeout=timeout)
            assert counted_search.looks <= timeout + 4
            assert counted_search.most_attempts <= REACH_ATTEMPTS
            assert counted_search.starts <= 2 * REACH_STARTS
