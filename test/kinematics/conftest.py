"""Arms of the inverse-kinematics tests, and an independent search to compare with."""

import sys
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, load_robot

sys.path.insert(0, str(Path(__file__).parent))

from counted_search import CountedSearch
from independent_search import multi_start, turn_difference

_FIRST = {"123": 0, "234": 1, "345": 2, "456": 3}
_KINDS = ("skew", "meeting", "parallel", "square")


def _three_parallel(name):
    """An arm with the named three axes parallel and the named position of its outer two axes.

    "234-meeting" has axes 5 and 6 (1 and 2 where the three are nearer to the tip) meeting in a
    point, "-parallel" has them parallel, "-skew" neither; "-square" arms have right angles
    throughout, and "-slide5" has a prismatic joint 5.
    """
    triple, kind = name.split("-")
    first = _FIRST[triple]
    slide = int(kind[-1]) - 1 if kind.startswith("slide") else None
    rng = np.random.default_rng([first, _KINDS.index(kind) if slide is None else 10 + slide])
    a, b = rng.uniform(0.1, 0.6, 6), rng.uniform(-0.4, 0.4, 6)
    alpha = rng.uniform(0.4, 2.7, 6) * rng.choice([-1, 1], 6)
    outer = 4 if triple in ("123", "234") else 0
    if kind == "square":
        alpha = rng.choice([-0.5, 0.5], 6) * np.pi
    if kind in ("meeting", "square"):
        a[outer] = 0.0
    if kind == "parallel":
        alpha[outer] = rng.choice([0.0, np.pi])
    alpha[first : first + 2] = rng.choice([0.0, np.pi], 2)
    types = None if slide is None else [int(joint == slide) for joint in range(6)]
    return chain_from_dh(a, b, alpha, types=types)


@pytest.fixture(scope="session")
def three_parallel_arm():
    """Make an arm with three parallel axes by name: a robot, "no-offset" or "<axes>-<kind>"."""
    made = {}

    def make(name):
        if name not in made:
            if name[0].isdigit():
                made[name] = _three_parallel(name)
            elif name == "no-offset":
                made[name] = chain_from_dh(
                    [0, -0.425, -0.392, 0, 0, 0],
                    [0.089, 0, 0, 0, 0.095, 0.082],
                    [np.pi / 2, 0, 0, np.pi / 2, -np.pi / 2, 0],
                )
            else:
                made[name] = load_robot(name)
        return made[name]

    return make


@pytest.fixture(scope="session")
def apart():
    """Return the function that measures how far postures are from each other."""
    return turn_difference


@pytest.fixture(scope="session")
def pose_errors():
    """Return the function for the largest entry of the pose at each q minus T."""

    def errors(chain, T, q):
        poses = forward_kinematics(chain, np.ascontiguousarray(q))
        return np.abs(poses - T).max(axis=(-2, -1))

    return errors


@pytest.fixture(scope="session")
def search_everywhere():
    """Return the oracle: distinct regular solutions from many random starts."""
    return multi_start


@pytest.fixture
def counted_search(monkeypatch):
    """Count the work of searches for joint values, which take a second for every look at it."""
    return CountedSearch(monkeypatch)
