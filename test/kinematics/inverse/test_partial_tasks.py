"""Partial tasks of arms with just as many joints: all solutions, against an independent search."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.robots import chain_from_dh, load_robot

POSITION = (True, True, True, False, False, False)
POINTING = (True, True, True, True, True, False)
FLAT = (True, True, False, True, True, True)


def part(name, link):
    chain = load_robot(name)
    return chain.with_tip(chain.links[link])


ARMS = {
    "three joints, position": (part("puma560", 3), POSITION),
    "three general joints, position": (
        chain_from_dh([0.2, 0.3, 0.25], [0.1, 0.05, 0.2], [1.1, 0.7, 0.4]),
        POSITION,
    ),
    "five joints, pointing along z": (load_robot("vx300"), POINTING),
    "five general joints, pointing along z": (
        chain_from_dh([0.1, 0.3, 0.2, 0.1, 0.1], [0.2, 0.1, 0, 0.1, 0.1], [1.2, 0.4, -1, 0.8, 1.3]),
        POINTING,
    ),
    "five joints, any height": (
        chain_from_dh([0.1, 0.3, 0.2, 0.1, 0.1], [0.2, 0.1, 0, 0.1, 0.1], [1.2, 0.4, -1, 0.8, 1.3]),
        FLAT,
    ),
}


def errors(chain, T, q, task):
    """Components of the error that the task counts, along and about the axes of the target."""
    now = forward_kinematics(chain, q)
    position = T[:3, :3].T @ (now[:3, 3] - T[:3, 3])
    turn = Rotation.from_matrix(T[:3, :3].T @ now[:3, :3]).as_rotvec()
    return np.concatenate((position, turn))[list(task)]


def apart(a, b):
    return np.abs(np.remainder(a - b + np.pi, 2 * np.pi) - np.pi).max(axis=-1)


@pytest.mark.parametrize("name", ARMS)
def test_all_solutions_of_random_poses(name):
    chain, task = ARMS[name]
    rng = np.random.default_rng(5)
    counts = []
    for q in rng.uniform(-np.pi, np.pi, (60, chain.n)):
        T = forward_kinematics(chain, q)
        # What does not count may be anything.
        free = ~np.array(task)
        turn = rng.uniform(-2, 2, 3) * free[3:]
        T[:3, :3] = T[:3, :3] @ Rotation.from_rotvec(turn).as_matrix()
        T[:3, 3] += T[:3, :3] @ (rng.uniform(-0.2, 0.2, 3) * free[:3])
        result = inverse_kinematics(chain, T, task_mask=task, respect_limits=False)
        assert result.complete and result.family == "short" and not result.reason
        assert apart(result.q, q).min() < 1e-6
        for solution in result.q:
            assert np.abs(errors(chain, T, solution, task)).max() < 1e-9
        assert all(
            apart(one, other) > 1e-6 for k, one in enumerate(result.q) for other in result.q[:k]
        )
        assert max(*result.position_error, *result.orientation_error) < 1e-9
        counts.append(len(result))
    assert max(counts) > 1


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, pytest.param(4, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", ARMS)
def test_nothing_is_missing(name, count):
    chain, task = ARMS[name]
    rng = np.random.default_rng(8)
    for q in rng.uniform(-np.pi, np.pi, (count, chain.n)):
        T = forward_kinematics(chain, q)
        ours = inverse_kinematics(chain, T, task_mask=task, respect_limits=False).q
        for start in rng.uniform(-np.pi, np.pi, (40, chain.n)):
            found = least_squares(
                lambda x, T=T: errors(chain, T, x, task), start, xtol=1e-14, ftol=1e-14
            )
            if np.abs(found.fun).max() < 1e-10:
                assert apart(ours, found.x).min() < 1e-5


def test_limits_and_windings_hold():
    chain = load_robot("vx300")
    q = np.array([0.4, 0.2, -0.3, 0.5, 0.1])
    T = forward_kinematics(chain, q) @ np.diag([-1.0, -1.0, 1.0, 1.0])
    result = inverse_kinematics(chain, T, task_mask=POINTING, seed=q)
    assert result.complete
    np.testing.assert_allclose(result.q[0], q, atol=1e-9)
    assert ((result.q >= chain.lower) & (result.q <= chain.upper)).all()
    endless = inverse_kinematics(chain, T, task_mask=POINTING, respect_limits=False)
    assert len(endless) >= len(result)
    capped = inverse_kinematics(chain, T, task_mask=POINTING, seed=q, max_solutions=1)
    assert len(capped) == 1


@pytest.mark.parametrize(
    ("elbow", "mark"),
    [
        (0.9, ""),
        (0.0, "at-boundary"),
        # The tip is on the first axis.
        (np.arccos(-1.25 * np.cos(1.2)) - 1.2, "self-motion"),
    ],
)
def test_positions_are_marked_where_the_arm_is_singular(elbow, mark):
    arm = chain_from_dh([0.0, 0.5, 0.4], [0.3, 0.0, 0.0], [np.pi / 2, 0.0, 0.0])
    T = forward_kinematics(arm, [0.3, 1.2, elbow])
    found = inverse_kinematics(arm, T, task_mask=POSITION)
    marks = {name.partition(" ")[2] for name in found.branches}
    assert marks == {mark} and found.continuum == (mark == "self-motion")
