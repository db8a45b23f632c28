"""Shared fixtures: golden files, random chains, and a separate network."""

import json
import os
import signal
import sys
from collections import Counter
from pathlib import Path

# One test per core: threads of OpenBLAS would only wait for one another.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros.nodes.process.free_domain import free_domain
from robomech_ros.robots import SerialChain, load_description, load_robot
from robomech_ros.robots.chain_layout import pack_chain

# Robots of our own that tests of several parts share.
sys.path.insert(0, str(Path(__file__).parent))

GOLDEN = Path(__file__).parent / "data" / "golden"
LOOPBACK = Path(__file__).parent / "data" / "loopback.xml"


def pytest_addoption(parser):
    """Declare the option by which `make test-fast` runs a part of the cases."""
    parser.addoption("--cases", type=int, help="run so many cases of each test at most, the first")


def pytest_collection_modifyitems(config, items):
    """Leave out the other cases of each test."""
    most, counts = config.getoption("cases"), Counter()
    if most:
        cases = list(items)
        items.clear()
        for item in cases:
            test = item.nodeid.partition("[")[0]
            counts[test] += 1
            if counts[test] <= most:
                items.append(item)


def pytest_configure():
    """Let Ctrl-C reach what the tests start, also where a shell runs them in the background."""
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def own_network():
    """Keep what the tests start on this machine, and in a ROS domain of this run alone."""
    with free_domain() as number:
        os.environ["ROS_DOMAIN_ID"] = str(number)
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SYSTEM_DEFAULT"
        # Jazzy knows the earlier name only, of which Kilted warns.
        middleware = "FASTRTPS" if "jazzy" in Path(sys.prefix).name else "FASTDDS"
        os.environ[f"{middleware}_DEFAULT_PROFILES_FILE"] = str(LOOPBACK)
        yield


@pytest.fixture(scope="session")
def golden():
    """Load a golden file by its stem."""
    return lambda name: json.loads((GOLDEN / f"{name}.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def pinocchio_model():
    """Make Pinocchio's model of a robot: from the URDF file, else from the chain of its table."""
    import pinocchio

    def make(name):
        chain, where = load_robot(name), load_description(name).where
        if where.endswith(".urdf"):
            # A joint without limits would be a point on a circle there, two numbers for an angle.
            text = Path(where).read_text(encoding="utf-8")
            bounded = text.replace('"continuous">', '"revolute">').replace(
                "<limit velocity", '<limit lower="-10" upper="10" velocity'
            )
            return pinocchio.buildModelFromXML(bounded)
        model, parent = pinocchio.Model(), 0
        rows = chain.packed
        placed = [pinocchio.SE3(row[1:10].reshape(3, 3).copy(), row[10:].copy()) for row in rows]
        for i, joint in enumerate(chain.joint_names):
            kind = pinocchio.JointModelPZ() if chain.types[i] else pinocchio.JointModelRZ()
            parent = model.addJoint(parent, kind, placed[i], joint)
        kind = pinocchio.FrameType.OP_FRAME
        model.addFrame(pinocchio.Frame(chain.tip, parent, placed[-1], kind))
        return model

    return make


def _random_transform(rng, kind):
    """A transform after which the next z axis is general, or special towards the one before."""
    T = np.eye(4)
    turn = Rotation.random(rng=rng).as_matrix()
    spin = Rotation.from_rotvec([0, 0, rng.uniform(-3, 3)]).as_matrix()
    if kind == "general":
        T[:3, :3], T[:3, 3] = turn, rng.normal(size=3)
    elif kind == "intersecting":
        T[:3, :3] = turn
        T[:3, 3] = rng.normal() * turn[:, 2] + [0, 0, rng.normal()]
    elif kind == "parallel":
        T[:3, :3], T[:3, 3] = spin, rng.normal(size=3)
    elif kind == "antiparallel":
        T[:3, :3], T[:3, 3] = spin @ np.diag([1.0, -1.0, -1.0]), rng.normal(size=3)
    elif kind == "coincident":
        T[:3, :3], T[:3, 3] = spin, [0, 0, rng.normal()]
    return T


@pytest.fixture(scope="session")
def random_chain():
    """Make a random chain of R and P joints whose neighbouring axes take special positions."""
    kinds = ("general", "intersecting", "parallel", "antiparallel", "coincident")

    def make(seed, n=6, types=None, kind=None):
        rng = np.random.default_rng(seed)
        types = rng.integers(0, 2, n) if types is None else np.array(types)
        chosen = [kind or kinds[rng.integers(len(kinds))] for _ in range(n + 1)]
        transforms = np.array([_random_transform(rng, one) for one in chosen])
        missing = np.full(n, np.nan)
        return SerialChain(
            name=f"random-{seed}",
            base="base_link",
            tip="tool0",
            joint_names=tuple(f"joint_{i + 1}" for i in range(n)),
            types=types,
            packed=pack_chain(transforms, types),
            lower=np.full(n, -np.inf),
            upper=np.full(n, np.inf),
            velocity=missing,
            acceleration=missing,
            jerk=missing,
            effort=missing,
        )

    return make
