"""Arms with three parallel axes at singular postures: always a solution, and the right flags."""

import numpy as np
import pytest
from zero_sets import turned_to

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, load_robot

POSES = 300
RESIDUAL = 1e-9
UNIVERSAL = ("ur5e", "no-offset")
SYNTHETIC = tuple(
    f"{axes}-{kind}"
    for axes in ("123", "234", "345", "456")
    for kind in ("skew", "meeting", "parallel", "square")
)
SLIDING = ("123-slide4", "123-slide5", "123-slide6", "234-slide1", "234-slide5", "234-slide6")


@pytest.mark.parametrize("robot", ["ur5e", "ur10e"])
def test_an_elbow_folded_onto_its_limit_is_found_on_that_side(robot):
    chain, rng = load_robot(robot), np.random.default_rng(5)
    for _ in range(100):
        q = rng.uniform(-3.0, 3.0, 6)
        q[2] = rng.choice([-np.pi, np.pi])
        result = inverse_kinematics(chain, forward_kinematics(chain, q), seed=q)
        assert result.complete
        assert result.seed_distance[0] < 1e-7
        assert result.q[0, 2] == pytest.approx(q[2], abs=1e-9)


def check(chain, q, pose_errors, rng):
    """Every pose has a solution, all solutions hold, for several seeds."""
    targets = forward_kinematics(chain, q)
    for part in np.array_split(np.arange(len(q)), 3):
        seed = rng.uniform(-np.pi, np.pi, chain.n)
        solutions, counts, status = inverse_kinematics_batch(
            chain, targets[part], seed=seed, respect_limits=False
        )
        assert (counts > 0).all(), q[part][counts == 0]
        assert (status == 0).all()
        rows = np.arange(solutions.shape[1]) < counts[:, None]
        errors = pose_errors(chain, np.repeat(targets[part], counts, axis=0), solutions[rows])
        assert errors.max() < RESIDUAL


@pytest.mark.parametrize("name", UNIVERSAL)
@pytest.mark.parametrize(
    "fixed", ({4: (0.0, np.pi)}, {2: (0.0, np.pi)}, {2: (0.0, np.pi), 4: (0.0, np.pi)})
)
def test_wrist_and_elbow(three_parallel_arm, pose_errors, name, fixed):
    chain = three_parallel_arm(name)
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (POSES, 6))
    for joint, values in fixed.items():
        q[:, joint] = rng.choice(values, POSES)
    check(chain, q, pose_errors, rng)


@pytest.mark.parametrize("name", UNIVERSAL + SYNTHETIC + SLIDING)
def test_quarter_turns(three_parallel_arm, pose_errors, name):
    chain = three_parallel_arm(name)
    rng = np.random.default_rng(2)
    q = rng.integers(-1, 3, (POSES, 6)) * (np.pi / 2)
    q[:, chain.types == 1] = rng.uniform(-0.3, 0.3, (POSES, 1)) * rng.integers(0, 2, (POSES, 1))
    check(chain, q, pose_errors, rng)


@pytest.mark.slow
@pytest.mark.parametrize("name", UNIVERSAL + SYNTHETIC + SLIDING)
def test_zero_determinant(three_parallel_arm, pose_errors, name):
    chain = three_parallel_arm(name)
    rng = np.random.default_rng(3)
    q = turned_to(lambda q: np.linalg.det(jacobian(chain, q)), chain, POSES, rng, range(6))
    check(chain, q, pose_errors, rng)


def postures_over_the_shoulder(chain, last_link, rng):
    """Postures with the point of axes 5 and 6 straight above the shoulder.

    ``last_link`` (m) is the distance of the tip from that point, along axis 6.
    """

    def level(q):
        pose = forward_kinematics(chain, q)
        x, y = (pose[:, :2, 3] - last_link * pose[:, :2, 2]).T
        return x * np.cos(q[:, 0]) + y * np.sin(q[:, 0])

    q = turned_to(level, chain, POSES, rng, (1, 2))
    assert np.abs(np.linalg.det(jacobian(chain, q))).max() < 1e-12
    return q


def test_shoulder(three_parallel_arm, pose_errors):
    """With an offset two solutions become one."""
    chain = three_parallel_arm("ur5e")
    rng = np.random.default_rng(4)
    q = postures_over_the_shoulder(chain, 0.0996, rng)
    check(chain, q, pose_errors, rng)
    for posture in q[:40]:
        T = forward_kinematics(chain, posture)
        result = inverse_kinematics(chain, T, seed=posture, respect_limits=False)
        assert np.abs(result.q[0] - posture).max() < 1e-6
        assert "at-boundary" in result.branches[0] and not result.continuum


def test_free_shoulder(three_parallel_arm, pose_errors):
    """Without an offset the same pose leaves joint 1 free to turn."""
    chain = three_parallel_arm("no-offset")
    rng = np.random.default_rng(5)
    q = postures_over_the_shoulder(chain, 0.082, rng)
    check(chain, q, pose_errors, rng)
    for posture in q[:40]:
        T = forward_kinematics(chain, posture)
        kept = inverse_kinematics(chain, T, seed=posture, respect_limits=False)
        assert kept.continuum and all("shoulder-singular" in branch for branch in kept.branches)
        assert np.abs(kept.q[0] - posture).max() < 1e-6


def test_free_wrist_keeps_joint_6_at_the_seed_where_the_arm_reaches(three_parallel_arm):
    chain = three_parallel_arm("ur5e")
    rng = np.random.default_rng(6)
    for _ in range(60):
        posture = rng.uniform(-np.pi, np.pi, 6)
        posture[4] = rng.choice([0.0, np.pi])
        T = forward_kinematics(chain, posture)
        result = inverse_kinematics(chain, T, seed=posture, respect_limits=False)
        assert result.continuum and result.status == 0
        singular = np.array(["wrist-singular" in branch for branch in result.branches])
        distance = np.abs(result.q[singular] - posture).max(axis=1)
        assert distance.min() < 1e-6


@pytest.mark.slow
def test_free_wrist_takes_the_nearest_joint_6_in_reach(three_parallel_arm):
    """The range of joint 6 in which the planar arm reaches, found here by trial."""
    chain = three_parallel_arm("ur5e")
    rng = np.random.default_rng(7)
    trials = np.linspace(-np.pi, np.pi, 361)
    tried = 0
    while tried < 12:
        posture = rng.uniform(-np.pi, np.pi, 6)
        posture[2], posture[4] = rng.uniform(-0.3, 0.3), 0.0
        T = forward_kinematics(chain, posture)
        inside = []
        for value in trials:
            seed = np.r_[posture[:5], value]
            q = inverse_kinematics(chain, T, seed=seed, respect_limits=False)
            free = ["wrist-singular" in branch for branch in q.branches]
            turned = np.abs((q.q[free][:, 5] - value + np.pi) % (2 * np.pi) - np.pi)
            inside.append(turned.min(initial=9.0))
        inside = np.array(inside)
        if inside.max() < 0.2:
            continue
        tried += 1
        feasible = trials[inside < 1e-9]
        for value, moved in zip(trials[::20], inside[::20], strict=True):
            gap = np.abs((feasible - value + np.pi) % (2 * np.pi) - np.pi).min()
            assert moved <= gap + 1e-9 and moved > gap - 1.01 * (trials[1] - trials[0])


def test_double_roots_are_one_solution(three_parallel_arm, apart):
    chain = three_parallel_arm("ur5e")
    rng = np.random.default_rng(8)
    for _ in range(100):
        posture = rng.uniform(-np.pi, np.pi, 6)
        posture[2] = 0.0
        T = forward_kinematics(chain, posture)
        result = inverse_kinematics(chain, T, respect_limits=False)
        distance = apart(chain, result.q[:, None], result.q[None]) + 9.0 * np.eye(len(result))
        assert distance.min() > 1e-6
        k = np.argmin(apart(chain, result.q, posture))
        assert apart(chain, result.q[k], posture) < 1e-6
        assert "at-boundary" in result.branches[k] and not result.continuum


def test_two_solutions_on_this_side_of_the_boundary_and_none_beyond(three_parallel_arm):
    chain = three_parallel_arm("ur5e")
    posture = np.array([0.4, -0.9, 0.0, -0.5, 1.1, 0.3])
    T = forward_kinematics(chain, posture)
    arm = forward_kinematics(chain.with_tip("wrist_1_link"), posture[:4])[:3, 3]
    shoulder = forward_kinematics(chain.with_tip("upper_arm_link"), posture[:2])[:3, 3]
    along = (arm - shoulder) / np.linalg.norm(arm - shoulder)
    counts = []
    for shift in (-1e-3, -1e-9, 1e-3):
        moved = T.copy()
        moved[:3, 3] += shift * along
        q = inverse_kinematics(chain, moved, respect_limits=False).q
        near = np.abs(q[:, 2]) < 0.2
        counts.append(int((near & (np.abs(q[:, 0] - posture[0]) < 0.1)).sum()))
    assert counts[0] >= 2 and counts[1] >= 2 and counts[2] == 0


def offset_wrist(first, number):
    """An arm with axes ``first`` to ``first`` + 2 parallel and the outer two at a distance.

    The others are at right angles, or, of every second arm, two neighbours parallel and the rest
    skew.
    """
    rng = np.random.default_rng([first, number])
    a, b = rng.uniform(0.1, 0.6, 6), rng.uniform(-0.4, 0.4, 6)
    alpha = rng.choice([-0.5, 0.5], 6) * np.pi
    beside = [i for i in range(5) if i < first - 1 or i > first + 2]
    if number % 2 and beside:
        alpha = rng.uniform(0.4, 1.4, 6) * rng.choice([-1.0, 1.0], 6)
        alpha[rng.choice(beside)] = rng.choice([0.0, np.pi])
    alpha[first : first + 2] = rng.choice([0.0, np.pi], 2)
    return chain_from_dh(a, b, alpha)


@pytest.mark.parametrize("number", range(6))
@pytest.mark.parametrize("first", range(4))
def test_offset_wrists_at_quarter_turns(apart, pose_errors, first, number):
    """Double roots of both equations coincide, or axis 6 is parallel to the three at one."""
    chain = offset_wrist(first, number)
    quarters = np.random.default_rng(number).integers(-1, 3, (40, 6)) * (np.pi / 2)
    for q in quarters:
        T = forward_kinematics(chain, q)
        result = inverse_kinematics(chain, T, seed=q)
        assert len(result), q
        assert pose_errors(chain, T, result.q).max() < RESIDUAL
        # Where four solutions have become one, the fourth root of the rounding is left.
        assert result.continuum or apart(chain, result.q, q).min() < 3e-3, q
