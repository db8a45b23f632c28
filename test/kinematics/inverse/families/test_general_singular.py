"""General arms at singular and square postures: the generating joints are always among the answers.

A posture belongs to a continuum where joints can move on while the tip stays; then the continuum is
reported.  Any other one is found, the nearer the fewer solutions have merged in it: a fold to the
square root of the rounding, a posture at which eight have become one to its eighth root.
"""

import numpy as np
import pytest
from general_arms import HALF, ROBOTS, SQUARES, TABLES, folds, general_arm, regularity, right_angles

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian

POSES = 200
RESIDUAL = 1e-9
AT_FOLD = 1e-5
AT_MULTIPLE = 2e-2
FAST = ("general6r", "fanuc_arcmate", "crx10ia", "slanted-wrist")
SLOW = tuple(
    name for name in (*ROBOTS, *TABLES, *SQUARES, "random-0", "random-1") if name not in FAST
)


def moves_on(chain, T, q, step=0.05):
    """Tell whether a posture with one rank lost can go on by a step while the tip stays."""
    direction = np.linalg.svd(jacobian(chain, q))[2][-1]
    x = q + step * direction
    for _ in range(15):
        pose = forward_kinematics(chain, x)
        turn = T[:3, :3] @ pose[:3, :3].T
        axial = 0.5 * (turn - turn.T)
        along = step - (x - q) @ direction
        error = (axial[2, 1], axial[0, 2], axial[1, 0], *(T[:3, 3] - pose[:3, 3]), along)
        J = np.vstack((jacobian(chain, x), direction))
        x = x + np.clip(np.linalg.lstsq(J, error, rcond=1e-10)[0], -0.1, 0.1)
    return np.abs(forward_kinematics(chain, x) - T).max() < 1e-12


def each(names, *marks):
    return [pytest.param(name, marks=marks) for name in names]


def check(chain, postures, apart, within):
    """Ask for every posture's pose; return how many are answered by a continuum."""
    continua = 0
    singular = regularity(chain, postures) < 1e-9
    for q, is_singular in zip(postures, singular, strict=True):
        result = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
        assert len(result), q
        assert max(result.position_error.max(), result.orientation_error.max()) < RESIDUAL
        assert not (result.continuum and result.complete)
        reported = is_singular and result.continuum
        nearest = apart(chain, result.q, q).min()
        assert reported or nearest < (within if is_singular else 1e-6), (q, result.complete)
        continua += result.continuum
    return continua


@pytest.mark.parametrize("name", [*each(FAST), *each(SLOW, pytest.mark.slow)])
def test_folds(apart, name):
    chain = general_arm(name)
    postures = folds(chain, POSES, 5)
    check(chain, postures, apart, AT_FOLD)


@pytest.mark.parametrize("name", [*each(FAST), *each(SLOW, pytest.mark.slow)])
def test_right_angles(apart, name):
    chain = general_arm(name)
    check(chain, right_angles(POSES, 6), apart, AT_MULTIPLE)


@pytest.mark.slow
@pytest.mark.parametrize("name", (*FAST, *SLOW))
def test_half_right_angles(apart, name):
    chain = general_arm(name)
    postures = np.random.default_rng(7).integers(-3, 5, (POSES, 6)) * (0.5 * HALF)
    check(chain, postures, apart, AT_MULTIPLE)


@pytest.mark.parametrize("name", (*FAST, *SLOW))
def test_zero_posture(apart, name):
    chain = general_arm(name)
    check(chain, np.zeros((1, 6)), apart, AT_MULTIPLE)


def of_two_ranks_less(chain, rng):
    """Postures at which the Jacobian has lost two ranks or more; joints 1 and 6 are random."""
    found = []
    grid = rng.permuted(np.indices((4,) * 4).reshape(4, -1).T, axis=0)[:, ::-1] * HALF
    for middle in grid:
        q = np.r_[0.0, middle, 0.0]
        if np.linalg.svd(jacobian(chain, q), compute_uv=False)[-2] < 1e-12:
            found.append(q)
    postures = np.array(found)[rng.integers(0, len(found), POSES)] if found else np.empty((0, 6))
    postures[:, [0, 5]] = rng.uniform(-np.pi, np.pi, (len(postures), 2))
    return postures


@pytest.mark.parametrize(
    "name", ["slanted-wrist", *each(("jaco2", "crx10ia", "square-3", "square-4"), pytest.mark.slow)]
)
def test_two_ranks_less(apart, name):
    chain = general_arm(name)
    postures = of_two_ranks_less(chain, np.random.default_rng(8))
    assert len(postures) == POSES
    check(chain, postures, apart, AT_MULTIPLE)


def test_a_fold_is_one_solution_and_no_continuum(apart):
    chain = general_arm("random-0")
    for q in folds(chain, 50, 9):
        result = inverse_kinematics(chain, forward_kinematics(chain, q), respect_limits=False)
        assert result.complete and not result.continuum
        nearest = np.argmin(apart(chain, result.q, q))
        assert "at-boundary" in result.branches[nearest]
        distance = apart(chain, result.q[:, None], result.q[None]) + 9.0 * np.eye(len(result))
        assert distance.min() > 1e-5


@pytest.mark.parametrize("name", ["crx10ia", *each(("jaco2", "slanted-wrist"), pytest.mark.slow)])
def test_no_posture_at_a_boundary_can_move_on(apart, name):
    chain = general_arm(name)
    postures = np.random.default_rng(7).integers(-3, 5, (POSES, 6)) * (0.5 * HALF)
    values = np.linalg.svd(jacobian(chain, postures), compute_uv=False)
    postures = postures[(values[:, 5] < 1e-9) & (values[:, 4] > 1e-3)]
    boundaries = 0
    for q in postures:
        T = forward_kinematics(chain, q)
        result = inverse_kinematics(chain, T, respect_limits=False)
        away = apart(chain, result.q, q)
        nearest = int(away.argmin())
        if away[nearest] < AT_MULTIPLE and "at-boundary" in result.branches[nearest]:
            boundaries += 1
            assert not moves_on(chain, T, q), q
    assert boundaries > 5


def test_a_continuum_is_told():
    """Here two joints of the arm can turn against each other, whatever joints 1 and 6 are."""
    chain = general_arm("offset-wrist-cobot")
    q = np.random.default_rng(10).uniform(-np.pi, np.pi, (40, 6))
    q[:, 1:5] = 0.0, -HALF, np.pi, -HALF
    for posture in q:
        result = inverse_kinematics(chain, forward_kinematics(chain, posture), respect_limits=False)
        assert result.continuum and not result.complete
        assert any("self-motion" in branch for branch in result.branches)
