"""Kinematic services of parallel robots: limb branches, assembly modes, singularities."""

import numpy as np
import pytest
from geometry_msgs.msg import Point
from sensor_msgs.msg import JointState, PointCloud2
from visualization_msgs.msg import Marker, MarkerArray

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import (
    AnalyzeSingularity,
    GetJacobian,
    QueryWorkspace,
    SolveFK,
    SolveIK,
    SolveIKBatch,
)
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.parallel import (
    list_parallel,
    load_parallel,
    loop_singularity,
    platform_length,
    platform_position_workspace,
)
from robomech_ros.spatial import matrix_from_rotation_vector


class Asked:
    """A kinematics node of a parallel robot, and somebody who asks."""

    def __init__(self, shared, name):
        self.graph = shared(KinematicsNode, robot_description=name)
        self.robot = load_parallel(name)
        self.mechanism = self.robot.mechanism
        self.home = self.mechanism.home()
        self.drives = self.home[self.mechanism.drive_index]

    def ask(self, kind, service, **fields):
        return self.graph.ask(kind, f"kinematics/{service}", **fields)

    def state(self, q):
        return joint_state(self.mechanism.joint_names, q)

    def of_drives(self, q):
        return joint_state(self.mechanism.actuated, q)

    def ik(self, T, frame="", **fields):
        fields.setdefault("seed", self.state(self.home))
        return self.ask(SolveIK, "solve_ik", target=stamped_pose(T, frame), **fields)

    def fk(self, *states, links=()):
        return self.ask(SolveFK, "solve_fk", states=list(states), links=list(links))


@pytest.fixture
def asked(shared):
    return lambda name: Asked(shared, name)


@pytest.fixture
def asked_first(graph):
    """Return a node that nobody has asked before."""

    def start(node, **parameters):
        graph.start(node, **parameters)
        return graph

    return lambda name: Asked(start, name)


def rows_of(response):
    return np.array([list(point.positions) for point in response.solutions])


def poses_of(response):
    return np.array([matrix_from_pose(pose.pose) for pose in response.poses])


@pytest.mark.parametrize("name", list_parallel())
def test_ik_gives_all_joints_in_all_branches_and_fk_the_pose_back(asked, name):
    node = asked(name)
    mechanism = node.mechanism
    T = mechanism.pose(mechanism.close(node.drives + 1e-3, node.home).q)
    response = node.ik(T)
    expected = mechanism.postures(T, seed=node.home)
    assert (response.error_code, response.error_msg) == (0, "")
    assert tuple(response.joint_names) == mechanism.joint_names
    q = rows_of(response)
    np.testing.assert_allclose(q, expected.q, atol=1e-12)
    assert response.branches == list(expected.branches)
    assert mechanism.loop_errors(q).max() < 1e-9
    assert max(response.position_errors + response.orientation_errors) < 1e-9
    assert list(response.seed_distances) == sorted(response.seed_distances)
    assert len(response.condition_numbers) == len(response.limit_margins) == len(q)
    # Limbs of any kind may have been searched.
    known = name not in ("linapod", "tripod_3prs")
    assert (response.complete, response.family) == (known, "parallel")
    back = node.fk(*(node.state(row) for row in q))
    assert back.error_code == ErrorCode.NONE, back.error_msg
    np.testing.assert_allclose(poses_of(back), np.broadcast_to(T, (len(q), 4, 4)), atol=1e-9)


@pytest.mark.parametrize(("name", "modes"), [("delta", 2), ("agile_eye", None), ("hexapod", None)])
def test_fk_of_the_drives_gives_all_assembly_modes_nearest_first(asked, name, modes):
    node = asked(name)
    drives = node.drives + 1e-3
    response = node.fk(node.of_drives(drives))
    expected = node.robot.direct(drives, seed=node.mechanism.pose(node.home))
    assert response.error_code == ErrorCode.NONE
    poses = poses_of(response)
    assert len(poses) == (modes or len(expected)) > 1
    np.testing.assert_allclose(poses, expected.poses, atol=1e-9)
    here = node.mechanism.pose(node.mechanism.close(drives, node.home).q)
    np.testing.assert_allclose(poses[0], here, atol=1e-9)
    assert f"{len(poses)} assembly modes" in response.error_msg
    assert "these are all" in response.error_msg


def test_fk_of_drives_beyond_their_limits_says_so(asked):
    node = asked("delta")
    drives = node.drives.copy()
    drives[1] = node.mechanism.upper[node.mechanism.drive_index[1]] + 0.3
    response = node.fk(node.of_drives(drives))
    assert response.error_code == ErrorCode.NONE
    assert "these are all; beyond limits: 2 of 2, number 1 with leg" in response.error_msg
    assert "beyond" not in node.fk(node.of_drives(node.drives)).error_msg


def test_fk_of_many_states_takes_the_nearest_mode_of_each_and_serves_links(asked):
    node = asked("delta")
    links = ["platform", "leg2_arm"]
    response = node.fk(node.of_drives(node.drives), node.state(node.home), links=links)
    assert response.error_code == ErrorCode.NONE, response.error_msg
    poses = poses_of(response)
    assert len(poses) == 4
    np.testing.assert_allclose(poses[:2], poses[2:], atol=1e-9)
    np.testing.assert_allclose(poses[0], node.mechanism.pose(node.home), atol=1e-9)


def test_fk_of_drives_that_hold_the_platform_nowhere_says_how_near_it_comes(asked):
    node = asked("planar_3rpr")
    lengths = np.array([0.01, 0.01, 5.0])
    response = node.fk(node.of_drives(lengths))
    found = node.robot.direct(lengths)
    assert (response.error_code, len(response.poses)) == (found.status, 0)
    assert response.error_code == ErrorCode.OUT_OF_REACH
    assert found.reason in response.error_msg


def test_states_that_leave_the_loops_open_are_refused_with_limb_and_amount(asked):
    node = asked("hexapod")
    q = node.home.copy()
    q[-1] += 0.2
    response = node.fk(node.state(q))
    assert response.error_code == ErrorCode.BAD_VALUE
    assert "states[0].position has open loops: limb 6 ends" in response.error_msg
    assert "0.2 rad" in response.error_msg
    # The gap is what helps, not the 36 numbers.
    assert f"{q[0]:.3f}" not in response.error_msg


def singular_posture(mechanism):
    """A hexapod whose platform is turned by a quarter: six legs on one linear complex."""
    T = mechanism.pose(mechanism.home())
    T[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    return mechanism.postures(T, ignore_limits=True).q[0]


def test_a_singular_posture_has_its_code(asked):
    node = asked("hexapod")
    singular = singular_posture(node.mechanism)
    response = node.ask(GetJacobian, "get_jacobian", state=node.state(singular))
    assert response.error_code == ErrorCode.SINGULAR
    assert "singular, expected one in which the drives hold the platform" in response.error_msg
    rounded = node.state(singular.round(5))
    response = node.ask(GetJacobian, "get_jacobian", state=rounded)
    assert response.error_code == ErrorCode.SINGULAR
    assert "singular" in response.error_msg


def test_legs_outside_their_strokes_block_by_name_and_amount(asked):
    node = asked("hexapod")
    T = node.mechanism.pose(node.home)
    T[2, 3] += 0.6
    response = node.ik(T)
    assert response.error_code == ErrorCode.LIMITS_EXCLUDE_ALL
    assert response.blocking_joints
    lengths = node.robot.inverse(T)
    for name, excess in zip(response.blocking_joints, response.blocking_excess, strict=True):
        leg = int(name.removeprefix("leg").split("_")[0]) - 1
        assert name == f"leg{leg + 1}_length"
        assert excess == pytest.approx(node.robot.excess(lengths)[leg], abs=1e-9)
    without = node.ik(T, ignore_limits=True)
    assert without.error_code == ErrorCode.NONE and without.solutions
    assert min(without.limit_margins) < 0.0


def test_a_posture_beyond_a_cone_has_a_negative_margin(asked):
    node = asked("hexapod")
    T = node.mechanism.pose(node.home)
    T[:3, :3] = matrix_from_rotation_vector([0.7, 0.0, 0.0]) @ T[:3, :3]
    assert not node.robot.excess(node.robot.inverse(T)).any()
    response = node.ik(T)
    assert response.error_code == ErrorCode.LIMITS_EXCLUDE_ALL
    beyond = node.ik(T, ignore_limits=True)
    worst = node.robot.cone_excess(T).max()
    assert worst > 0.0
    assert max(beyond.limit_margins) == pytest.approx(-worst, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "fields", "text"),
    [
        ("hexapod", {"tip_link": "leg1_rod"}, "'platform' or empty"),
        ("hexapod", {"task_mask": [True] * 3 + [False] * 3}, "task_mask"),
        ("hexapod", {"include_windings": True}, "include_windings"),
        ("hexapod", {"seed": JointState(position=[0.7] * 7)}, "6, of the drives, or 36"),
        ("delta", {"seed": JointState(name=["leg1_bse"], position=[0.1])}, "leg1_bse"),
        ("delta", {"seed": JointState(position=[0.1, 0.1, float("nan")])}, "leg3_base"),
    ],
)
def test_requests_that_no_parallel_robot_can_serve(asked, name, fields, text):
    node = asked(name)
    response = node.ik(node.mechanism.pose(node.home), **fields)
    assert 100 < response.error_code < 200
    assert text in response.error_msg


def test_the_base_has_no_jacobian(asked):
    node = asked("delta")
    response = node.ask(GetJacobian, "get_jacobian", tip_link="base_link")
    assert response.error_code == ErrorCode.BAD_VALUE
    assert "which joints move" in response.error_msg


def test_limbs_of_any_kind_say_why_they_miss_a_pose(asked):
    """They missed it "by inf m", wherever it was."""
    node = asked("tripod_3prs")
    T = node.mechanism.pose(node.home)
    T[:3, :3] = matrix_from_rotation_vector([0.6, 0.0, 0.0])
    response = node.ik(T)
    assert response.error_code == ErrorCode.ORIENTATION_UNREACHABLE
    assert response.error_msg.startswith("limb 2: the position (0, 0, 0.545436) m")
    assert "in reach, but not in this orientation" in response.error_msg
    T[0, 3] += 100.0
    response = node.ik(T)
    assert response.error_code == ErrorCode.OUT_OF_REACH
    assert "is out of reach by 9" in response.error_msg


def test_a_delta_cannot_tilt(asked):
    node = asked("delta")
    T = node.mechanism.pose(node.home)
    T[:3, :3] = np.diag([1.0, -1.0, -1.0])
    response = node.ik(T)
    assert response.error_code == ErrorCode.BAD_VALUE
    assert "turn of the pose is 3.14159265" in response.error_msg
    assert not response.solutions


@pytest.mark.parametrize("name", ["hexapod", "delta", "planar_3rrr", "agile_eye"])
def test_jacobian_is_the_difference_of_poses_for_each_drive(asked, name):
    node = asked(name)
    mechanism, point = node.mechanism, np.array([0.02, -0.01, 0.03])
    response = node.ask(
        GetJacobian,
        "get_jacobian",
        state=node.state(node.home),
        tool_point=Point(x=point[0], y=point[1], z=point[2]),
    )
    assert response.error_code == ErrorCode.NONE, response.error_msg
    assert tuple(response.joint_names) == mechanism.actuated
    J = np.array(response.jacobian).reshape(6, mechanism.dof)
    step = 1e-6
    for k in range(mechanism.dof):
        ends = []
        for sign in (-1.0, 1.0):
            drives = node.drives.copy()
            drives[k] += sign * step
            T = mechanism.pose(mechanism.close(drives, node.home).q)
            ends.append((T[:3, :3] @ point + T[:3, 3], T[:3, :3]))
        (before, R0), (after, R1) = ends
        np.testing.assert_allclose(J[:3, k], (after - before) / (2 * step), atol=1e-6)
        W = (R1 - R0) @ mechanism.pose(node.home)[:3, :3].T / (2 * step)
        np.testing.assert_allclose(J[3:, k], [W[2, 1], W[0, 2], W[1, 0]], atol=1e-6)


def test_singularity_of_a_regular_posture(asked):
    node = asked("hexapod")
    response = node.ask(
        AnalyzeSingularity, "analyze_singularity", state=node.of_drives(node.drives)
    )
    expected = loop_singularity(node.robot, node.mechanism.pose(node.home))
    assert response.error_code == ErrorCode.NONE, response.error_msg
    np.testing.assert_allclose(response.singular_values, expected.singular_values, rtol=1e-6)
    assert response.rank == 6
    assert response.characteristic_length == pytest.approx(expected.length)
    assert response.normalised_condition_number == pytest.approx(expected.condition_number)
    assert not response.singularity_types and not response.lost_directions
    assert response.summary.startswith("regular")
    twists = node.mechanism.twist_matrix(node.home)
    assert response.condition_number == pytest.approx(np.linalg.cond(twists))


@pytest.mark.parametrize("name", ["tripod_3prs", "linapod"])
def test_singularities_of_limbs_of_any_kind(asked, name):
    node = asked(name)
    response = node.ask(
        AnalyzeSingularity, "analyze_singularity", state=node.of_drives(node.drives)
    )
    pose = node.mechanism.pose(node.home)
    expected = loop_singularity(node.mechanism, pose, node.home)
    assert response.error_code == ErrorCode.NONE, response.error_msg
    assert response.rank == node.mechanism.dof and response.summary.startswith("regular")
    np.testing.assert_allclose(response.singular_values, expected.singular_values, rtol=1e-6)
    assert response.normalised_condition_number == pytest.approx(expected.condition_number)


def test_singularity_of_the_first_kind_names_the_limb_and_the_lost_motion(asked):
    """Limb 1 is stretched straight."""
    node = asked("planar_3rrr")
    mechanism = node.mechanism
    base, proximal, distal = (
        node.robot.base_points[0],
        node.robot.proximal[0],
        node.robot.distal[0],
    )
    way = node.robot.base_points.mean(axis=0) - base
    tip = base + (proximal + distal) * way / np.linalg.norm(way)
    found = None
    for angle in np.linspace(-np.pi, np.pi, 721):
        c, s = np.cos(angle), np.sin(angle)
        x, y = tip - np.array([[c, -s], [s, c]]) @ node.robot.platform_points[0]
        T = np.eye(4)
        T[:2, :2], T[:2, 3] = [[c, -s], [s, c]], (x, y)
        rows = mechanism.postures(T, ignore_limits=True).q
        if len(rows) and loop_singularity(node.robot, T, rows[0][mechanism.drive_index]).type == 1:
            found = rows[0]
            break
    assert found is not None
    response = node.ask(AnalyzeSingularity, "analyze_singularity", state=node.state(found))
    assert response.error_code == ErrorCode.NONE, response.error_msg
    assert any("type 1" in kind and "limb 1" in kind for kind in response.singularity_types)
    assert len(response.lost_directions) == 1
    assert "type 1" in response.summary


def test_condition_numbers_of_limbs_of_any_kind_are_those_of_the_characteristic_length(asked):
    """They were taken over the size of the robot."""
    node = asked("tripod_3prs")
    T = node.mechanism.pose(node.home)
    space = node.ask(QueryWorkspace, "query_workspace", poses=[stamped_pose(T, "")])
    assert space.error_code == ErrorCode.NONE, space.error_msg
    every = [node.mechanism.twist_matrix(q) for q in node.mechanism.postures(T).q]
    scale = np.repeat([1.0, platform_length(node.mechanism)], 3)[:, None]
    least = min(np.linalg.cond(twists / scale) for twists in every)
    assert space.condition_numbers[0] == pytest.approx(least, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "step", "rays"), [("hexapod", 0.03, 1000), ("planar_3rrr", 0.1, 100)]
)
def test_distances_from_the_boundary_with_its_markers_and_cloud(asked_first, name, step, rays):
    """They were NaN, and there were no markers."""
    node = asked_first(name)
    T = node.mechanism.pose(node.home)
    poses = np.stack([T] * 4)
    poses[1, 0, 3] += step
    poses[2, 0, 3] += 1.2 * node.mechanism.size + 10.0 * step
    poses[3, :3, :3] = matrix_from_rotation_vector([0.0, 0.0, 0.1]) @ T[:3, :3]
    messages = [stamped_pose(one, "") for one in poses]
    first = node.ask(QueryWorkspace, "query_workspace", poses=messages[:1])
    space = node.ask(QueryWorkspace, "query_workspace", poses=messages)
    assert space.error_code == ErrorCode.NONE, space.error_msg
    assert list(space.reachable) == [True, True, False, True]
    assert first.boundary_distances[0] == space.boundary_distances[0]
    for k in (0, 1, 3):
        exact = platform_position_workspace(node.robot, poses[k], directions=rays)
        assert space.boundary_distances[k] == pytest.approx(
            exact.distances.min(), abs=0.01 * exact.distances.max()
        )
    far = np.linalg.norm(poses[2, :3, 3] - T[:3, 3])
    reach = platform_position_workspace(node.robot, T, directions=rays).distances
    assert -far + 0.9 * reach.min() < space.boundary_distances[2] < -far + 1.1 * reach.max()
    assert 0.0 <= space.least_reach < space.greatest_reach < np.inf
    shown = node.graph.receive(
        MarkerArray, "kinematics/markers", LATCHED, lambda m: len(m.markers) > 1
    )
    surface = shown.markers[1]
    points = np.array([[p.x, p.y, p.z] for p in surface.points])
    assert surface.ns == "workspace"
    flat = name == "planar_3rrr"
    assert surface.type == (Marker.LINE_LIST if flat else Marker.TRIANGLE_LIST)
    assert len(points) % (2 if flat else 3) == 0
    away = np.linalg.norm(points - T[:3, 3], axis=1)
    assert away.min() >= 0.99 * reach.min() and away.max() <= 1.1 * reach.max()
    cloud = node.graph.receive(PointCloud2, "kinematics/workspace", LATCHED, lambda m: m.width == 4)
    rows = np.frombuffer(cloud.data.tobytes(), np.float32).reshape(4, 5)
    np.testing.assert_allclose(rows[:, 4], space.boundary_distances, rtol=1e-6)


@pytest.mark.parametrize(("name", "corners"), [("tripod_3prs", 1), ("linapod", 3)])
def test_distances_of_limbs_of_any_kind(asked, name, corners):
    """The tripod moves along a line as long as it does not turn."""
    node = asked(name)
    T = node.mechanism.pose(node.home)
    up = T.copy()
    up[2, 3] += 0.05
    # What takes long is found in one request after the other: the length, then the boundary.
    found = node.ask(AnalyzeSingularity, "analyze_singularity", state=node.state(node.home))
    assert found.error_code == ErrorCode.NONE, found.error_msg
    space = node.ask(
        QueryWorkspace, "query_workspace", poses=[stamped_pose(one, "") for one in (T, up)]
    )
    assert space.error_code == ErrorCode.NONE, space.error_msg
    assert list(space.reachable) == [True, True]
    away = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
    along = platform_position_workspace(node.mechanism, T, directions=away).distances
    first, second = space.boundary_distances
    assert 0.0 < first <= along.min() + 1e-9
    assert 0.0 < second <= along[0] - 0.05 + 1e-9
    if corners == 1:
        assert first == pytest.approx(along.min())
        assert second == pytest.approx(along[0] - 0.05)
    assert 0.0 < space.least_reach < space.greatest_reach < 2.0
    shown = node.graph.receive(
        MarkerArray, "kinematics/markers", LATCHED, lambda m: m.markers[-1].ns == "workspace"
    )
    surface = shown.markers[-1]
    assert surface.type == (Marker.TRIANGLE_LIST if corners > 1 else Marker.LINE_LIST)
    assert len(surface.points) % max(corners, 2) == 0


def test_markers_of_a_singular_posture(asked):
    node = asked("hexapod")
    singular = singular_posture(node.mechanism)
    response = node.ask(AnalyzeSingularity, "analyze_singularity", state=node.state(singular))
    assert response.error_code == ErrorCode.NONE, response.error_msg
    assert "type 2" in response.summary

    def names(message):
        return {marker.ns for marker in message.markers[1:]}

    node.graph.receive(
        MarkerArray, "kinematics/markers", LATCHED, lambda m: "free_directions" in names(m)
    )
    response = node.ask(AnalyzeSingularity, "analyze_singularity", state=node.state(node.home))
    ellipsoids = {"velocity_ellipsoid", "force_ellipsoid"}
    node.graph.receive(MarkerArray, "kinematics/markers", LATCHED, lambda m: ellipsoids <= names(m))


def test_a_platform_that_only_turns_has_no_boundary_of_positions(asked):
    node = asked("agile_eye")
    pose = stamped_pose(node.mechanism.pose(node.home), "")
    space = node.ask(QueryWorkspace, "query_workspace", poses=[pose])
    assert space.error_code == ErrorCode.NONE, space.error_msg
    assert list(space.reachable) == [True]
    assert np.isnan([*space.boundary_distances, space.least_reach, space.greatest_reach]).all()


@pytest.mark.parametrize("name", ["hexapod", "delta"])
def test_batch_and_workspace_agree_with_single_poses(asked, name):
    node = asked(name)
    T = node.mechanism.pose(node.home)
    far = T.copy()
    far[2, 3] += 10.0
    poses = [stamped_pose(one, "") for one in (T, far)]
    rows = []
    for pose in poses:
        p, o = pose.pose.position, pose.pose.orientation
        rows += [p.x, p.y, p.z, o.x, o.y, o.z, o.w]
    seed = node.home.tolist()
    batch = node.ask(SolveIKBatch, "solve_ik_batch", poses=rows, seed=seed)
    single = node.ik(T)
    assert batch.error_code == ErrorCode.NONE, batch.error_msg
    assert tuple(batch.joint_names) == node.mechanism.joint_names
    assert list(batch.counts) == [len(single.solutions), 0]
    solutions = np.array(batch.solutions).reshape(-1, node.mechanism.n)
    np.testing.assert_allclose(solutions, rows_of(single), atol=1e-12)
    assert batch.codes[0] == ErrorCode.NONE
    assert batch.codes[1] in (ErrorCode.OUT_OF_REACH, ErrorCode.LIMITS_EXCLUDE_ALL)
    space = node.ask(QueryWorkspace, "query_workspace", poses=poses)
    assert space.error_code == ErrorCode.NONE, space.error_msg
    assert list(space.reachable) == [True, False]
    assert list(space.reason) == list(batch.codes)
    assert list(space.solution_count) == list(batch.counts)
    assert 1.0 <= space.condition_numbers[0] < np.inf == space.condition_numbers[1]
