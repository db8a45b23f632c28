"""Random platforms and library robots by the thousand, against a search that shares no code."""

import numpy as np
import pytest
from platforms import independent_poses, random_pose
from scipy.spatial.transform import Rotation

from robomech_ros.outcomes import Code
from robomech_ros.parallel import StewartGough, load_parallel

# A pose that two routes have found: of a pose near a singular one fewer digits are common.
SAME = 1e-6


def missed_by(found, poses):
    """Which of some poses, regular ones, are not among those found."""
    if len(poses) == 0:
        return []
    if len(found) == 0:
        return list(range(len(poses)))
    apart = np.abs(poses[:, None] - found.poses[None]).max(axis=(2, 3)).min(axis=1)
    return np.flatnonzero(apart > SAME).tolist()


def study_of_one(seed, starts):
    """Return the faults in the answers for a random platform, as text, and its number of modes."""
    rng = np.random.default_rng([16, seed])
    robot = StewartGough(*rng.normal(size=(2, 6, 3)))
    T = random_pose(robot, rng)
    lengths = robot.inverse(T)
    found = robot.direct(lengths, T)
    wrong = []
    if missed_by(found, T[None]):
        wrong.append(f"{seed}: the generating pose is missing")
    if np.abs(robot.inverse(found.poses) - lengths).max(initial=0.0) >= 1e-9:
        wrong.append(f"{seed}: a residual of 1e-9 m or more")
    searched = independent_poses(robot, lengths, starts, seed=seed)
    if found.complete and missed_by(found, searched):
        wrong.append(f"{seed}: complete, but a search found another pose")
    # Lengths of nothing in particular: many have no pose at all.
    lengths = rng.uniform(0.3, 4.0, size=6)
    other = robot.direct(lengths)
    searched = independent_poses(robot, lengths, starts, seed=seed)
    if other.complete and missed_by(other, searched):
        wrong.append(f"{seed}: complete for other lengths, but a search found another pose")
    if other.complete and len(other) == 0 and other.status != Code.OUT_OF_REACH:
        wrong.append(f"{seed}: no pose, answered as {other.status!r}")
    empty = other.complete and len(other) == 0
    return wrong, found.complete, other.complete, empty


def study(seeds, starts):
    wrong, complete, empty = [], 0, 0
    for seed in seeds:
        found, one, two, none = study_of_one(seed, starts)
        wrong += found
        complete += one + two
        empty += none
    return wrong, complete, empty


@pytest.mark.slow
def test_a_few_random_platforms_against_a_search():
    wrong, complete, empty = study(range(12), 100)
    assert wrong == []
    assert complete == 24 and empty > 0


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("piece", range(10))
def test_a_thousand_random_platforms_against_a_search(piece):
    wrong, complete, empty = study(range(100 * piece, 100 * (piece + 1)), 300)
    assert wrong == []
    # What is not certified says so; that must be rare.
    assert complete >= 198 and empty > 10


def generating_poses(name, count):
    """Poses of a robot of the library with the joints that make them."""
    robot, rng = load_parallel(name), np.random.default_rng(7)
    drawn = 0
    while drawn < count:
        if isinstance(robot, StewartGough):
            T = random_pose(robot, rng, 0.7 * np.abs(robot.base_points).max())
            lengths = robot.inverse(T)
            if robot.excess(lengths).any():
                continue
            drawn += 1
            yield robot, T, lengths
            continue
        T = np.eye(4)
        if name == "agile_eye":
            T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
        elif name == "delta":
            T[:3, 3] = rng.uniform([-0.7, -0.7, -1.6], [0.7, 0.7, -0.4])
        else:
            size = 1.0 if name == "planar_3rrr" else 15.0
            T[:2, 3] = size * rng.uniform(0.0, 1.0, size=2)
            T[:3, :3] = Rotation.from_euler("z", rng.uniform(-np.pi, np.pi)).as_matrix()
        found = robot.inverse(T)
        if name == "planar_3rpr":
            drawn += 1
            yield robot, T, found
        elif len(found):
            drawn += 1
            yield robot, T, found.q[rng.integers(len(found))]


def not_among_the_answers(name, count):
    wrong = []
    for k, (robot, T, joints) in enumerate(generating_poses(name, count)):
        found = robot.direct(joints, T)
        if missed_by(found, T[None]) or found.errors.max() >= 1e-9 or not found.complete:
            wrong.append((k, T.tolist(), len(found), found.reason))
    return wrong


LIBRARY = (
    "agile_eye",
    "delta",
    "dietmaier",
    "hexapod",
    "planar_3rpr",
    "planar_3rrr",
    "sgp_3_3",
    "sgp_6_3",
)


@pytest.mark.parametrize("name", LIBRARY)
def test_poses_of_library_robots_are_among_the_answers(name):
    assert not_among_the_answers(name, 20) == []


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", LIBRARY)
def test_a_thousand_poses_of_each_library_robot_are_among_the_answers(name):
    assert not_among_the_answers(name, 1000) == []
