"""Well-known arms at their well-known singularities: what they answer, and when it is a continuum.

A posture on a singularity belongs to a continuum where joints can move on while the tip stays; it
does not where two solutions merge.  Which it is for each arm, its table below says.
"""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot

POSES = 300
RESIDUAL = 1e-9

# For each arm and singularity the word in the name of the branch.  An offset between axis 1 and
# the arm (all but irb120) lets two solutions merge where the shoulder would be free to turn.
WORDS = {
    "puma560": {"wrist": "wrist-singular", "elbow": "at-boundary", "shoulder": "at-boundary"},
    "irb120": {"wrist": "wrist-singular", "elbow": "at-boundary", "shoulder": "shoulder-singular"},
    "stanford": {"wrist": "wrist-singular", "elbow": "elbow-singular", "shoulder": "at-boundary"},
    "ur5e": {"wrist": "wrist-singular", "elbow": "at-boundary", "shoulder": "at-boundary"},
}
ONE = [(name, (kind,)) for name, words in WORDS.items() for kind in words]
SEVERAL = [
    (name, kinds)
    for name in WORDS
    for kinds in (
        ("wrist", "elbow"),
        ("wrist", "shoulder"),
        ("elbow", "shoulder"),
        ("wrist", "elbow", "shoulder"),
    )
]


def random_postures(name, rng):
    q = rng.uniform(-np.pi, np.pi, (POSES, 6))
    if name == "stanford":
        q[:, 2] = rng.uniform(0.3, 1.2, POSES)
    return q


def centre(chain, q):
    """Return the intersection (m) of the last axes: three of them, two for the ur5e."""
    pose = forward_kinematics(chain, q)
    return pose[..., :3, 3] - chain.dh.b[5] * pose[..., :3, 2]


def put_on_elbow(name, chain, q, rng):
    """Stretch or fold the arm, so that joint 3 leaves its centre's distance from axis 2."""
    if name == "stanford":
        q[:, 2] = 0.0
        return
    q[:, 2] = rng.choice([0.0, np.pi], len(q))
    if name == "ur5e":
        return
    # The squared distance is of first order in the cosine and sine of q_3.
    at = np.zeros((3, 6))
    at[:, 2] = 0.0, np.pi / 2, np.pi
    away = centre(chain, at) - [0.0, 0.0, chain.dh.b[0]]
    square = away[:, 0] ** 2 + away[:, 2] ** 2
    middle = 0.5 * (square[0] + square[2])
    q[:, 2] += np.arctan2(square[1] - middle, square[0] - middle)


def put_on_shoulder(name, chain, q, rng):
    """Put the centre above or below axis 1, as far as the arm's offset lets it."""
    if name == "stanford":
        q[:, 1] = rng.choice([0.0, np.pi], len(q))
        return
    # Its way out in the arm's plane is of first order in the cosine and sine of q_2.
    at = np.concatenate((q, q))
    at[:, 0] = 0.0
    at[: len(q), 1], at[len(q) :, 1] = 0.0, np.pi / 2
    out = centre(chain, at)[:, 0]
    q[:, 1] = np.arctan2(-out[: len(q)], out[len(q) :]) + rng.choice([0.0, np.pi], len(q))


def singular_postures(name, kinds, rng):
    chain = load_robot(name)
    q = random_postures(name, rng)
    if "wrist" in kinds:
        q[:, 4] = rng.choice([0.0, np.pi], len(q))
    if "elbow" in kinds:
        put_on_elbow(name, chain, q, rng)
    if "shoulder" in kinds:
        put_on_shoulder(name, chain, q, rng)
    return chain, np.angle(np.exp(1j * q)) if name != "stanford" else q


def check_batch(chain, q, pose_errors):
    """Every pose has a solution, and all solutions hold, for the default seed."""
    targets = forward_kinematics(chain, q)
    solutions, counts, status = inverse_kinematics_batch(chain, targets, respect_limits=False)
    assert (counts > 0).all() and (status == 0).all(), q[counts == 0][:3]
    rows = np.arange(solutions.shape[1]) < counts[:, None]
    errors = pose_errors(chain, np.repeat(targets, counts, axis=0), solutions[rows])
    assert errors.max() < RESIDUAL
    return targets


@pytest.mark.parametrize(("name", "kinds"), ONE + SEVERAL)
def test_every_pose_is_answered(pose_errors, name, kinds):
    chain, q = singular_postures(name, kinds, np.random.default_rng(1))
    assert np.abs(np.linalg.det(jacobian(chain, q))).max() < 1e-12
    check_batch(chain, q, pose_errors)


@pytest.mark.parametrize(("name", "kinds"), ONE)
def test_a_continuum_is_told_where_there_is_one(apart, name, kinds):
    word = WORDS[name][kinds[0]]
    chain, q = singular_postures(name, kinds, np.random.default_rng(2))
    for posture, T in zip(q, forward_kinematics(chain, q), strict=True):
        result = inverse_kinematics(chain, T, seed=posture, respect_limits=False)
        assert result.continuum == (word != "at-boundary"), posture
        assert result.complete != result.continuum
        assert result.position_error.max() < RESIDUAL
        assert result.orientation_error.max() < RESIDUAL
        # At a double root half of the arm's digits remain, and fewer of a nearly singular wrist.
        distance = np.abs(np.angle(np.exp(1j * (result.q[:, :3] - posture[:3])))).max(axis=1)
        nearest = np.argmin(distance + 1e-6 * apart(chain, result.q, posture))
        assert distance[nearest] < 1e-5, posture
        assert word in result.branches[nearest], (posture, result.branches)


@pytest.mark.parametrize(("name", "kinds"), SEVERAL)
def test_a_continuum_of_several_singularities_is_told(name, kinds):
    free = any(WORDS[name][kind] != "at-boundary" for kind in kinds)
    chain, q = singular_postures(name, kinds, np.random.default_rng(3))
    for posture, T in zip(q, forward_kinematics(chain, q), strict=True):
        result = inverse_kinematics(chain, T, seed=posture, respect_limits=False)
        assert len(result) and result.continuum == free, posture


@pytest.mark.parametrize(("name", "kinds"), ONE + SEVERAL)
def test_generating_joints_are_among_the_solutions(apart, name, kinds):
    """Or in a continuum that is reported, whatever the seed."""
    chain, q = singular_postures(name, kinds, np.random.default_rng(1))
    for posture, T in zip(q, forward_kinematics(chain, q), strict=True):
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert result.continuum or apart(chain, result.q, posture).min() < 1e-4, posture
        assert not (result.continuum and result.complete)


# Arms of seven joints: which joint makes the shoulder, the elbow and the wrist singular.
SEVEN = {"panda": (1, 3, 5), "iiwa14": (1, 3, 5)}
SEVEN_KINDS = ((), (0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2), "quarter turns")


@pytest.mark.parametrize("kinds", SEVEN_KINDS)
@pytest.mark.parametrize("name", SEVEN)
def test_seven_joints(pose_errors, apart, name, kinds):
    """Every pose is answered, and with the generating joints where they are the seed."""
    chain, rng = load_robot(name), np.random.default_rng(6)
    q = rng.uniform(-np.pi, np.pi, (200, 7))
    if kinds == "quarter turns":
        q = rng.integers(-1, 3, (200, 7)) * (np.pi / 2)
    else:
        for kind in kinds:
            q[:, SEVEN[name][kind]] = rng.choice([0.0, np.pi], len(q))
    targets = check_batch(chain, q, pose_errors)
    for posture, T in zip(q, targets, strict=True):
        result = inverse_kinematics(chain, T, seed=posture, respect_limits=False)
        assert apart(chain, result.q, posture).min() < 1e-6, posture
        assert result.position_error.max() < RESIDUAL


@pytest.mark.parametrize("name", WORDS)
def test_joints_at_quarter_turns(pose_errors, apart, name):
    chain = load_robot(name)
    rng = np.random.default_rng(4)
    q = rng.integers(-1, 3, (POSES, 6)) * (np.pi / 2)
    if name == "stanford":
        q[:, 2] = rng.choice([0.0, 0.5, 1.0], POSES)
    targets = check_batch(chain, q, pose_errors)
    for posture, T in zip(q, targets, strict=True):
        result = inverse_kinematics(chain, T, seed=posture, respect_limits=False)
        assert result.continuum or np.sin(posture[4]) ** 2 > 0.5, posture
        assert result.position_error.max() < RESIDUAL
    for posture, T in zip(q, targets, strict=True):
        result = inverse_kinematics(chain, T, respect_limits=False)
        assert result.continuum or apart(chain, result.q, posture).min() < 1e-5, posture
