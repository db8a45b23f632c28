"""The door to inverse kinematics: options, order, limits, windings, reasons, refusals."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    NonFiniteError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.kinematics import (
    Status,
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, list_robots, load_robot

POSTURE = np.array([0.5, -1.2, 1.4, -0.7, 0.9, 0.3])


@pytest.fixture(scope="module")
def ur5e():
    return load_robot("ur5e")


@pytest.fixture(scope="module")
def target(ur5e):
    return forward_kinematics(ur5e, POSTURE)


@pytest.mark.parametrize("name", list_robots())
def test_every_robot_reaches_a_posture_of_its_own(name, pose_errors):
    chain = load_robot(name)
    q = chain.midrange() + 0.1 * np.linspace(0.5, 1.0, chain.n)
    q = np.clip(q, chain.lower, chain.upper)
    T = forward_kinematics(chain, q)
    result = inverse_kinematics(chain, T, seed=q)
    assert result.status is Status.SUCCESS and len(result) > 0
    assert pose_errors(chain, T, result.q).max() < 2e-9
    assert (result.q >= chain.lower).all() and (result.q <= chain.upper).all()
    assert result.seed_distance[0] < 1e-4


@pytest.mark.parametrize(("metric", "order"), [("linf", np.inf), ("l2", 2)])
def test_nearest_to_the_seed_comes_first(ur5e, target, metric, order):
    seed = POSTURE + 0.4
    result = inverse_kinematics(ur5e, target, seed=seed, metric=metric)
    distance = np.linalg.norm(result.q - seed, ord=order, axis=1)
    np.testing.assert_allclose(result.seed_distance, distance, atol=1e-12)
    assert (np.diff(distance) >= 0).all()
    assert len(result.branches) == len(set(result.branches)) == 8


def test_figures_of_a_solution(ur5e, target):
    result = inverse_kinematics(ur5e, target)
    assert result.complete and result.family == "three-parallel" and result.reason == ""
    assert not result.continuum
    assert result.position_error.max() < 1e-12 and result.orientation_error.max() < 1e-12
    margin = np.minimum(result.q - ur5e.lower, ur5e.upper - result.q).min(axis=1)
    np.testing.assert_allclose(result.limit_margin, margin)
    values = np.linalg.svd(jacobian(ur5e, result.q), compute_uv=False)
    np.testing.assert_allclose(result.condition_number, values[:, 0] / values[:, -1], rtol=1e-9)


def test_windings_of_a_solution(ur5e, target, apart):
    plain = inverse_kinematics(ur5e, target, seed=POSTURE)
    wound = inverse_kinematics(ur5e, target, seed=POSTURE, include_windings=True)
    inside = [
        sum(ur5e.lower[i] <= q + 2 * np.pi * k <= ur5e.upper[i] for k in range(-3, 4))
        for row in plain.q
        for i, q in enumerate(row)
    ]
    counts = np.array(inside).reshape(-1, 6).prod(axis=1)
    assert len(wound) == counts.sum() > 8 * len(plain)
    assert len(np.unique(wound.q.round(6), axis=0)) == len(wound)
    assert (np.diff(wound.seed_distance) >= 0).all()
    assert (apart(ur5e, wound.q[:, None], plain.q[None]).min(axis=1) < 1e-9).all()
    assert wound.complete


def test_the_winding_nearest_to_the_seed(ur5e, target):
    seed = POSTURE.copy()
    seed[5] -= 2 * np.pi - 1.0
    nearest = inverse_kinematics(ur5e, target, seed=seed, max_solutions=1)
    assert len(nearest) == 1
    np.testing.assert_allclose(nearest.q[0], [*POSTURE[:5], POSTURE[5] - 2 * np.pi], atol=1e-9)


@pytest.mark.parametrize("name", ["puma560", "ur5e", "panda", "scara"])
def test_the_same_request_gives_the_same_bytes(name):
    chain = load_robot(name)
    T = forward_kinematics(chain, chain.midrange() + 0.1)
    first, second = (inverse_kinematics(chain, T, include_windings=True) for _ in range(2))
    assert first.q.tobytes() == second.q.tobytes()
    assert first.condition_number.tobytes() == second.condition_number.tobytes()
    assert first.branches == second.branches


@pytest.mark.parametrize("name", ["puma560", "ur5e", "stanford", "irb120", "panda", "planar3r"])
def test_out_of_reach_says_by_how_much(name):
    chain = load_robot(name)
    T = forward_kinematics(chain, chain.midrange())
    T[:2, 3] += 20.0, 20.0
    if name == "stanford":
        assert inverse_kinematics(chain, T).status is Status.LIMITS_EXCLUDE_ALL
        return
    result = inverse_kinematics(chain, T)
    assert result.status is Status.OUT_OF_REACH and len(result) == 0
    said = float(result.reason.split("out of reach by ")[1].split(" m")[0])
    rng = np.random.default_rng(0)
    tips = forward_kinematics(chain, rng.uniform(-np.pi, np.pi, (20_000, chain.n)))[:, :3, 3]
    nearest = np.linalg.norm(tips - T[:3, 3], axis=1).min()
    assert nearest - 0.2 < said < nearest


def test_orientation_out_of_reach():
    # A tool that points inwards needs a longer arm than one that points outwards: on the way out
    # the orientation fails first, the position later.
    chain = load_robot("irb120")
    T = forward_kinematics(chain, np.array([0.0, 1.2, -1.2, 0.0, 0.0, 0.0]))
    T[:3, :3] = T[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    T[:3, 3] += 0.25 * T[:3, 2] * [1, 1, 0]
    seen = []
    for _ in range(200):
        result = inverse_kinematics(chain, T, respect_limits=False)
        if result.status not in seen:
            seen.append(result.status)
        if result.status is Status.ORIENTATION_UNREACHABLE:
            assert "in reach, but not in this orientation" in result.reason
            assert "rad away" in result.reason
        T[:3, 3] += 5e-3 * T[:3, 2] * [-1, -1, 0]
    assert seen == [Status.SUCCESS, Status.ORIENTATION_UNREACHABLE, Status.OUT_OF_REACH]


def test_limits_that_exclude_all_are_named():
    chain = load_robot("irb120")
    postures = np.random.default_rng(4).uniform(-np.pi, np.pi, (300, 6))
    excluded = 0
    for T in forward_kinematics(chain, postures):
        result = inverse_kinematics(chain, T)
        free = inverse_kinematics(chain, T, respect_limits=False)
        assert len(free) and (len(result) > 0) == (free.limit_margin >= -1e-10).any()
        if len(result):
            continue
        excluded += 1
        assert result.status is Status.LIMITS_EXCLUDE_ALL and result.complete
        least = np.maximum(chain.lower - free.q, free.q - chain.upper).max(axis=1).min()
        assert result.blocking_excess.max() == pytest.approx(least, abs=1e-9)
        for joint, amount in zip(result.blocking_joints, result.blocking_excess, strict=True):
            assert f"joint '{joint}' by {amount:.6g} rad" in result.reason
    assert excluded > 20


@pytest.mark.parametrize("name", ["puma560", "ur5e", "irb120"])
def test_a_continuum_is_told_and_stays_inside_the_limits(name, pose_errors):
    chain = load_robot(name)
    q = chain.midrange() + [0.3, -0.4, 0.5, 0.6, 0.0, -0.3]
    q[4] = 0.0
    T = forward_kinematics(chain, q)
    result = inverse_kinematics(chain, T, seed=q)
    assert result.status is Status.SUCCESS and result.continuum and not result.complete
    assert "can move while the tip stays" in result.reason
    assert any("wrist-singular" in branch for branch in result.branches)
    assert np.isinf(result.condition_number).any() or result.condition_number.max() > 1e9
    assert pose_errors(chain, T, result.q).max() < 1e-9
    assert result.seed_distance[0] < 1e-6


@pytest.mark.parametrize("name", ["puma560", "ur5e", "irb120", "stanford"])
def test_the_direction_of_a_self_motion_keeps_the_tip_at_rest(name):
    chain = load_robot(name)
    q = np.where(chain.types == 1, 0.3, [0.3, -0.4, 0.5, 0.6, 0.0, -0.3])
    T = forward_kinematics(chain, q)
    result = inverse_kinematics(chain, T, seed=q, respect_limits=False)
    text = result.reason.split("in the direction (")[1].split(")")[0]
    direction = np.array([float(entry) for entry in text.split(",")])
    first = next(k for k, branch in enumerate(result.branches) if "singular" in branch)
    assert np.linalg.norm(direction) == pytest.approx(1.0, abs=1e-5)
    assert np.abs(jacobian(chain, result.q[first]) @ direction).max() < 1e-5
    moving = [name for name, part in zip(chain.joint_names, direction, strict=True) if part]
    assert all(f"'{name}'" in result.reason for name in moving) and len(moving) > 1


@pytest.mark.parametrize(
    ("name", "mask"),
    [
        ("puma560", (True, True, True, False, False, False)),
        ("puma560", (True, True, True, True, True, False)),
        ("scara", (True, True, True, False, False, True)),
        ("planar3r", (True, True, False, False, False, True)),
    ],
)
def test_partial_tasks_in_the_axes_of_the_target(name, mask):
    chain = load_robot(name)
    q = chain.midrange() + np.where(chain.types == 1, 0.01, 0.15)
    T = forward_kinematics(chain, q)
    result = inverse_kinematics(chain, T, task_mask=mask)
    assert result.status is Status.SUCCESS and not result.complete
    reached = np.linalg.inv(T) @ forward_kinematics(chain, result.q)
    wanted = np.array(mask)
    assert np.abs(reached[:, :3, 3][:, wanted[:3]]).max() < 1e-8
    assert result.position_error.max() < 1e-8 and result.orientation_error.max() < 1e-8
    if mask == (True, True, True, True, True, False):
        # Free about the tool's own axis: the axis itself points where it should.
        np.testing.assert_allclose(reached[:, :3, 2], [[0, 0, 1]] * len(result), atol=1e-7)
        assert np.abs(reached[:, 0, 1]).max() > 0.1


def test_a_tolerance_lets_a_near_miss_through():
    chain = load_robot("puma560")
    T = forward_kinematics(chain, [0.2, 0.3, -np.pi / 2 - 0.047, 0.1, 0.4, 0.2])
    outward = T[:3, 3] - [0.0, 0.0, T[2, 3]]
    for _ in range(200):
        if not len(inverse_kinematics(chain, T, respect_limits=False)):
            break
        T[:3, 3] += 2e-3 * outward / np.linalg.norm(outward)
    assert not len(inverse_kinematics(chain, T, respect_limits=False))
    loose = inverse_kinematics(
        chain, T, respect_limits=False, position_tolerance=5e-3, orientation_tolerance=5e-3
    )
    assert loose.family == "iterative" and len(loose)
    assert 1e-9 < loose.position_error.max() <= 5e-3


def test_a_timeout_ends_a_search(counted_search):
    chain = load_robot("panda")
    T = forward_kinematics(chain, chain.midrange())
    T[0, 3] += 5.0
    result = inverse_kinematics(chain, T, timeout=6.5)
    assert counted_search.looks <= 6.5 + 4
    assert result.status is Status.TIMED_OUT and "6.5 s" in result.reason
    # The search for the nearest posture has the time that is left.
    chain = load_robot("planar3r")
    T = forward_kinematics(chain, chain.midrange())
    T[0, 3] += 5.0
    counted_search.forget()
    assert inverse_kinematics(chain, T, timeout=2.5).nearest is not None
    assert counted_search.looks <= 2.5 + 3


def test_batch_agrees_with_single_calls(ur5e):
    rng = np.random.default_rng(3)
    T = forward_kinematics(ur5e, rng.uniform(-3, 3, (40, 6)))
    T[5, :3, 3] += 9.0
    q, count, status = inverse_kinematics_batch(ur5e, T, seed=POSTURE)
    assert q.shape == (40, 16, 6)
    for k, target in enumerate(T):
        single = inverse_kinematics(ur5e, target, seed=POSTURE)
        assert count[k] == len(single) and status[k] == single.status
        assert q[k, : count[k]].tobytes() == single.q.tobytes()
        assert np.isnan(q[k, count[k] :]).all()
    assert status[5] == Status.OUT_OF_REACH
    nearest, one, _ = inverse_kinematics_batch(ur5e, T, seed=POSTURE, max_solutions=1)
    assert nearest.shape == (40, 1, 6) and one.max() == 1
    np.testing.assert_array_equal(nearest[:, 0], q[:, 0])


@pytest.mark.parametrize("name", ["puma560", "irb120", "stanford"])
def test_a_batch_tells_a_continuum_outside_the_limits(name):
    """Only representatives of a continuum are tried: limits may exclude part of it."""
    chain = load_robot(name)
    quarters = np.random.default_rng(0).integers(-1, 3, (60, 6)) * (np.pi / 2)
    T = forward_kinematics(chain, np.where(chain.types == 1, 0.1, quarters))
    q, count, status = inverse_kinematics_batch(chain, T)
    for k, target in enumerate(T):
        single = inverse_kinematics(chain, target)
        assert Status(status[k]) is single.status
        assert q[k, : count[k]].tobytes() == single.q.tobytes()
    assert (status == Status.SINGULAR_CONTINUUM).any()
    assert (status == Status.LIMITS_EXCLUDE_ALL).any()


def test_the_layout_of_arguments_makes_no_difference_and_they_stay(ur5e, target):
    """Read-only, Fortran-ordered, strided, of single precision, or lists."""
    seed = POSTURE.astype(np.float32)
    wanted = inverse_kinematics(ur5e, target, seed=seed)
    frozen, frozen_seed = target.copy(), seed.astype(float)
    frozen.setflags(write=False)
    frozen_seed.setflags(write=False)
    wide, wide_seed = np.zeros((4, 8)), np.zeros(12)
    wide[:, ::2], wide_seed[::2] = target, frozen_seed
    for T, start in (
        (frozen, frozen_seed),
        (np.asfortranarray(target), frozen_seed.tolist()),
        (target.tolist(), wide_seed[::2]),
        (wide[:, ::2], frozen_seed),
    ):
        given = np.array(T), np.array(start)
        one = inverse_kinematics(ur5e, T, seed=start)
        assert one.q.tobytes() == wanted.q.tobytes()
        q, count, _ = inverse_kinematics_batch(ur5e, [T], seed=start)
        assert q[0, : count[0]].tobytes() == wanted.q.tobytes()
        assert np.array_equal(T, given[0]) and np.array_equal(start, given[1])


def test_threads_do_not_disturb_each_other():
    """The same answers from several threads, each with an arm of its own, as from one."""

    def solve(name):
        chain = load_robot(name)
        postures = np.clip(np.random.default_rng(0).uniform(-2, 2, (40, chain.n)), -3, 3)
        targets = forward_kinematics(chain, postures)
        singles = [inverse_kinematics(chain, T, respect_limits=False).q.tobytes() for T in targets]
        return singles, inverse_kinematics_batch(chain, targets, respect_limits=False)[0].tobytes()

    names = ["puma560", "ur5e", "stanford", "panda"] * 3
    alone = {name: solve(name) for name in set(names)}
    with ThreadPoolExecutor(len(names)) as pool:
        for name, found in zip(names, pool.map(solve, names), strict=True):
            assert found == alone[name]


def test_an_empty_batch(ur5e):
    q, count, status = inverse_kinematics_batch(ur5e, np.empty((0, 4, 4)))
    assert q.shape == (0, 16, 6) and len(count) == len(status) == 0


def test_a_rotation_off_by_rounding_is_made_orthogonal(ur5e, target):
    off = target.copy()
    off[:3, :3] = off[:3, :3].round(7)
    result = inverse_kinematics(ur5e, off, seed=POSTURE)
    assert np.abs(result.q[0] - POSTURE).max() < 1e-5
    given = off.copy()
    inverse_kinematics(ur5e, off)
    np.testing.assert_array_equal(off, given)


def bad(target, row, column, value):
    T = target.copy()
    T[row, column] = value
    return T


@pytest.mark.parametrize(
    ("change", "error", "text"),
    [
        (lambda T: T[:3], WrongSizeError, r"T has shape \(3, 4\), expected \(4, 4\)"),
        (lambda T: np.stack([T, T]), WrongSizeError, "inverse_kinematics_batch takes many"),
        (lambda T: bad(T, 0, 3, np.nan), NonFiniteError, r"T\[0, 3\] is nan"),
        (lambda T: bad(T, 1, 1, np.inf), NonFiniteError, r"T\[1, 1\] is inf"),
        (lambda T: bad(T, 0, 0, T[0, 0] + 0.1), BadValueError, "it is off by"),
        (lambda T: T * [[-1], [1], [1], [1]], BadValueError, "it is off by inf"),
        (lambda T: bad(T, 3, 3, 2.0), BadValueError, "last row of T is"),
        (lambda T: "pose", BadValueError, "real numbers"),
    ],
)
def test_bad_targets_are_refused(ur5e, target, change, error, text):
    with pytest.raises(error, match=text):
        inverse_kinematics(ur5e, change(target))


def test_a_bad_target_of_a_batch_is_named(ur5e, target):
    with pytest.raises(NonFiniteError, match=r"T\[2\]\[0, 3\] is nan"):
        inverse_kinematics_batch(ur5e, np.stack([target, target, bad(target, 0, 3, np.nan)]))


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"seed": [0.0] * 5}, WrongSizeError, "seed has shape"),
        ({"seed": [[0.0] * 6]}, WrongSizeError, "seed has shape"),
        ({"seed": [0, 0, np.nan, 0, 0, 0]}, NonFiniteError, "seed of joint 'elbow_joint'"),
        ({"seed": [0, 7, 0, 0, 0, 0]}, SeedOutsideLimitsError, "'shoulder_lift_joint' is 7"),
        ({"metric": "l1"}, BadValueError, "'linf' or 'l2'"),
        ({"max_solutions": 0}, BadValueError, "at least 1"),
        ({"task_mask": [True] * 5}, WrongSizeError, "6: x, y, z, rx, ry, rz"),
        ({"timeout": -1.0}, BadValueError, "positive"),
        ({"position_tolerance": 0.0}, BadValueError, "positive"),
        ({"orientation_tolerance": np.nan}, NonFiniteError, "orientation_tolerance"),
    ],
)
def test_bad_options_are_refused(ur5e, target, options, error, text):
    with pytest.raises(error, match=text):
        inverse_kinematics(ur5e, target, **options)


def test_a_seed_may_be_a_micrometre_or_microradian_outside(ur5e, target):
    seed = ur5e.midrange()
    seed[1] = ur5e.upper[1] + 0.9e-6
    assert len(inverse_kinematics(ur5e, target, seed=seed)) == 8
    seed[1] = ur5e.upper[1] + 1.1e-6
    with pytest.raises(SeedOutsideLimitsError, match="'shoulder_lift_joint'"):
        inverse_kinematics(ur5e, target, seed=seed)


def test_a_seed_outside_the_limits_serves_where_they_do_not_hold(ur5e, target):
    seed = POSTURE.copy()
    seed[5] = 9.0
    result = inverse_kinematics(ur5e, target, seed=seed, respect_limits=False)
    assert len(result) == 8


def test_more_windings_than_can_be_listed_are_refused():
    half = np.pi / 2
    chain = chain_from_dh(
        [0, 0.4318, 0.0203, 0, 0, 0],
        [0, 0, 0.15005, 0.4318, 0, 0],
        [half, 0, -half, half, -half, 0],
        limits=np.tile([-1e4, 1e4], (6, 1)),
    )
    T = forward_kinematics(chain, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2])
    with pytest.raises(BadValueError, match="at most 8192 windings"):
        inverse_kinematics(chain, T, include_windings=True)
    assert len(inverse_kinematics(chain, T)) == 8


def test_a_joint_with_an_upper_limit_alone(pose_errors):
    half = np.pi / 2
    chain = chain_from_dh(
        [0, 0.4318, 0.0203, 0, 0, 0],
        [0, 0, 0.15005, 0.4318, 0, 0],
        [half, 0, -half, half, -half, 0],
        limits=np.tile([-np.inf, 1.0], (6, 1)),
    )
    T = forward_kinematics(chain, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2])
    result = inverse_kinematics(chain, T)
    assert len(result) == 8 and (result.q <= 1.0).all()
    assert pose_errors(chain, T, result.q).max() < 1e-9


def layouts(T):
    """The same pose as arrays of every memory layout, one not even aligned."""
    wide = np.zeros((8, 8))
    wide[::2, ::2] = T
    constant = T.copy()
    constant.setflags(write=False)
    room = np.zeros(129, np.uint8)[1:]
    room[:] = np.frombuffer(T.tobytes(), np.uint8)
    shifted = room.view(np.float64).reshape(4, 4)
    return [np.asfortranarray(T), wide[::2, ::2], constant, shifted, T.astype(">f8"), T.tolist()]


def test_a_target_may_have_any_memory_layout_and_is_left_alone():
    chain = load_robot("puma560")
    T = forward_kinematics(chain, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2])
    expected = inverse_kinematics(chain, T, respect_limits=False)
    assert len(expected) == 8
    for target in layouts(T):
        result = inverse_kinematics(chain, target, respect_limits=False)
        assert (result.q == expected.q).all() and (np.asarray(target) == T).all()
        assert (result.target == expected.target).all()


def test_fields_that_are_read_late_are_those_of_their_pose():
    chain = load_robot("ur5e")
    poses = forward_kinematics(chain, np.random.default_rng(5).uniform(-1.5, 1.5, (20, 6)))
    seed = np.full(6, 0.1)
    results = [inverse_kinematics(chain, T, seed=seed, max_solutions=5) for T in poses]
    for T, result in zip(poses, results, strict=True):
        twin = pickle.loads(pickle.dumps(copy.copy(result)))
        away = np.abs(result.q - seed).max(axis=1)
        for one in (result, twin, replace(result, q=result.q.copy())):
            assert one.target == pytest.approx(T, abs=1e-15)
            assert one.seed_distance == pytest.approx(away, abs=1e-15)
            assert one.branch_bits.dtype == np.int64 and len(one.branches) == len(one)
        with pytest.raises(AttributeError, match="'InverseKinematicsResult'.*'seed_distances'"):
            result.seed_distances  # noqa: B018
        with pytest.raises(FrozenInstanceError):
            result.q = None
