"""Parallel robots in the installed suite, compared with separate formulae in this file."""

import re

import numpy as np
import pytest
import yaml
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import JointState

from robomech_interfaces.srv import AnalyzeSingularity, QueryWorkspace, SolveIK
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose


@pytest.fixture
def described(repository):
    """Read what the file of a robot says."""

    def read(name):
        return yaml.safe_load((repository / f"config/robots/parallel/{name}.yaml").read_text())

    return read


def node_of(suite, name):
    return suite.node("kinematics_node", "-p", f"robot_description:={name}")


def angles_between(u, v):
    lengths = np.linalg.norm(u, axis=-1) * np.linalg.norm(v, axis=-1)
    return np.arccos(np.einsum("...i,...i->...", u, v) / lengths)


def test_the_workspace_of_the_hexapod_is_that_of_its_strokes_and_cones(suite, outsider, described):
    robot, rng = described("hexapod"), np.random.default_rng(20)
    R = Rotation.from_rotvec(rng.uniform(-0.3, 0.3, (5, 3))).as_matrix().repeat(400, axis=0)
    x = rng.uniform([-0.2, -0.2, 0.35], [0.2, 0.2, 0.7], (len(R), 3))
    above = np.einsum("kij,lj->kli", R, robot["platform_points"])
    legs = x[:, None] + above - robot["base_points"]
    lengths = np.linalg.norm(legs, axis=-1)
    shortest, longest = robot["strokes"]
    below = robot["base_cones"]
    bends = angles_between(legs, np.array(below["axes"])) - below["angles"]
    below = robot["platform_cones"]
    axes = np.einsum("kij,lj->kli", R, below["axes"])
    turns = angles_between(-legs, axes) - below["angles"]
    excesses = np.concatenate([shortest - lengths, lengths - longest, bends, turns], axis=1)
    inside = (excesses <= 0.0).all(axis=1)
    T = np.tile(np.eye(4), (len(x), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, x
    request = QueryWorkspace.Request(poses=[stamped_pose(one, "") for one in T])
    with node_of(suite, "hexapod"):
        space = outsider.call(QueryWorkspace, "kinematics/query_workspace", request)
    assert space.error_code == 0, space.error_msg
    assert 200 < inside.sum() < 1800
    np.testing.assert_array_equal(space.reachable, inside)
    distances = np.array(space.boundary_distances)
    # 0 is near the boundary.
    assert not (distances[inside] < 0.0).any() and not (distances[~inside] > 0.0).any()


def test_a_delta_whose_forearms_lie_in_a_plane_is_singular_of_type_2(suite, outsider, described):
    """Nothing holds the platform perpendicular to that plane."""
    robot = described("delta")
    azimuths = np.deg2rad([-90.0, 30.0, 150.0])
    outward = np.array([np.cos(azimuths), np.sin(azimuths), np.zeros(3)]).T
    centre = robot["base_radius"] - robot["platform_radius"]

    def elbows(drives):
        """They are the centres of spheres on which the platform is."""
        ways = np.array([np.cos(drives), np.sin(drives)]) * robot["arm"]
        return (centre + ways[0])[:, None] * outward - ways[1][:, None] * [0.0, 0.0, 1.0]

    def middle(first):
        """Return the middle of a circle through elbows 2 and 3, opposite elbow 1, and its error."""
        one, two, three = elbows(np.array([first, 0.9, 0.9]))
        between, half = 0.5 * (two + three), 0.5 * np.linalg.norm(three - two)
        way = one - between
        place = between - way / np.linalg.norm(way) * np.sqrt(robot["forearm"] ** 2 - half**2)
        return place, np.linalg.norm(one - place) - robot["forearm"]

    drives = [brentq(lambda first: middle(first)[1], 1.2, 2.2, xtol=1e-15), 0.9, 0.9]
    T = np.eye(4)
    T[:3, 3] = middle(drives[0])[0]
    with node_of(suite, "delta"):
        request = SolveIK.Request(target=stamped_pose(T, ""))
        found = outsider.call(SolveIK, "kinematics/solve_ik", request)
        assert found.error_code == 0, found.error_msg
        rows = np.array([one.positions for one in found.solutions])
        driven = [name.endswith("_base") for name in found.joint_names]
        nearest = np.abs(rows[:, driven] - drives).max(axis=1).argmin()
        np.testing.assert_allclose(rows[nearest, driven], drives, atol=1e-6)
        state = JointState(name=found.joint_names, position=rows[nearest])
        request = AnalyzeSingularity.Request(state=state)
        told = outsider.call(AnalyzeSingularity, "kinematics/analyze_singularity", request)
    assert told.error_code == 0, told.error_msg
    assert list(told.singularity_types) == ["type 2: limbs 1, 2, 3"] and told.rank == 2
    free = np.array(re.search(r"free: \[(.*)\] m/s with", told.summary)[1].split(), dtype=float)
    forearms = elbows(np.array(drives)) - T[:3, 3]
    np.testing.assert_allclose(np.linalg.norm(forearms, axis=1), robot["forearm"], rtol=1e-12)
    np.testing.assert_allclose(forearms @ free, 0.0, atol=2e-3)
