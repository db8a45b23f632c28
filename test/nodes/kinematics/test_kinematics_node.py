"""The kinematics node: right answers, over real DDS."""

import numpy as np
import pytest
from geometry_msgs.msg import Point
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from waiting import publish_present

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import AnalyzeSingularity, GetJacobian, SolveFK, SolveIK, SolveIKBatch
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import characteristic_length, jacobian, singularity_report
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.kinematics.kinematic_results import distances_between
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.robots import load_description, load_robot
from robomech_ros.spatial import matrix_from_axis_angle, pose_from_matrix

PUMA = load_robot("puma560")
Q = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])


@pytest.fixture
def puma(shared):
    return shared(KinematicsNode, robot_description="puma560")


@pytest.fixture
def own_puma(graph):
    """A node of one test alone."""
    graph.start(KinematicsNode, robot_description="puma560")
    return graph


def solve_ik(graph, **fields):
    return graph.ask(SolveIK, "kinematics/solve_ik", **fields)


def solve_fk(graph, **fields):
    return graph.ask(SolveFK, "kinematics/solve_fk", **fields)


def get_jacobian(graph, **fields):
    return graph.ask(GetJacobian, "kinematics/get_jacobian", **fields)


def target(q=Q, chain=PUMA, frame=""):
    return stamped_pose(forward_kinematics(chain, q), frame)


def test_poses_are_apart_by_a_length_and_an_angle():
    angles, T = np.array([0.0, 1e-8, 0.3, 2.0, np.pi]), forward_kinematics(PUMA, Q)
    turned = matrix_from_axis_angle([0.6, 0.0, 0.8], angles)
    moved = pose_from_matrix(turned @ T[:3, :3], T[:3, 3] + [0.3, 0.0, 0.4])
    apart, angle = distances_between(np.tile(T, (5, 1, 1)), moved)
    np.testing.assert_allclose(apart, 0.5)
    np.testing.assert_allclose(angle, angles, atol=3e-8)


def positions(response):
    return np.array([list(point.positions) for point in response.solutions])


def test_fk_of_many_states_and_links_is_state_major(puma):
    states = [joint_state(PUMA.joint_names, q) for q in (Q, 0.5 * Q)]
    links = ["tool0", PUMA.links[2]]
    response = solve_fk(puma, states=states, links=links)
    assert (response.error_code, response.error_msg) == (0, "")
    expected = [
        forward_kinematics(chain, q[: chain.n])
        for q in (Q, 0.5 * Q)
        for chain in (PUMA, PUMA.with_tip(links[1]))
    ]
    assert len(response.poses) == 4
    for pose, T in zip(response.poses, expected, strict=True):
        np.testing.assert_allclose(matrix_from_pose(pose.pose), T, atol=1e-14)
        assert pose.header.frame_id == PUMA.base


def test_issue_13_the_base_alone_needs_no_joint_state(puma):
    """Its code was 900: the fastest of no joints was looked for."""
    response = solve_fk(puma, links=[PUMA.base])
    assert (response.error_code, response.error_msg) == (0, "")
    assert [matrix_from_pose(pose.pose).tolist() for pose in response.poses] == [np.eye(4).tolist()]


def test_fk_takes_states_without_names_in_the_order_of_the_chain(puma):
    links = ["tool0", PUMA.links[2], PUMA.base]
    named = solve_fk(puma, states=[joint_state(PUMA.joint_names, Q)], links=links)
    unnamed = solve_fk(puma, states=[joint_state((), Q)], links=links)
    assert named.error_code == 0
    assert named.poses == unnamed.poses
    assert matrix_from_pose(named.poses[2].pose).tolist() == np.eye(4).tolist()


def test_ik_gives_all_solutions_nearest_first_with_every_list_filled(puma):
    seed = joint_state(PUMA.joint_names[::-1], Q[::-1])
    response = solve_ik(puma, target=target(), seed=seed, ignore_limits=True)
    expected = inverse_kinematics(PUMA, forward_kinematics(PUMA, Q), seed=Q, respect_limits=False)
    assert (response.error_code, response.complete) == (0, True)
    assert response.joint_names == list(PUMA.joint_names)
    assert response.family == expected.family == "decoupled"
    # A joint half a turn away from its seed may be given either way.
    turns = (positions(response) - expected.q) / (2.0 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-9)
    k = len(expected.q)
    assert k == 8
    np.testing.assert_allclose(positions(response)[0], Q, atol=1e-9)
    assert np.all(np.diff(response.seed_distances) >= 0.0)
    assert max(response.position_errors) < 1e-9
    assert max(response.orientation_errors) < 1e-9
    assert min(response.condition_numbers) >= 1.0
    lists = (
        response.seed_distances,
        response.position_errors,
        response.orientation_errors,
        response.condition_numbers,
        response.limit_margins,
        response.branches,
    )
    assert [len(entries) for entries in lists] == [k] * len(lists)
    assert len(set(response.branches)) == 8
    assert response.solve_time.sec == 0
    assert response.solve_time.nanosec > 0


def test_limits_hold_unless_they_are_ignored(puma):
    inside = solve_ik(puma, target=target(), seed=joint_state((), Q))
    everything = solve_ik(puma, target=target(), seed=joint_state((), Q), ignore_limits=True)
    assert 0 < len(inside.solutions) < len(everything.solutions)
    assert min(inside.limit_margins) >= 0.0 > min(everything.limit_margins)


def test_nearest_and_a_cap_cut_the_list(puma):
    seed = joint_state((), Q)
    everything = solve_ik(puma, target=target(), seed=seed, ignore_limits=True)
    nearest = solve_ik(
        puma, target=target(), seed=seed, ignore_limits=True, mode=SolveIK.Request.NEAREST
    )
    three = solve_ik(puma, target=target(), seed=seed, ignore_limits=True, max_solutions=3)
    assert positions(nearest).tolist() == positions(everything)[:1].tolist()
    assert positions(three).tolist() == positions(everything)[:3].tolist()
    assert nearest.complete
    assert three.complete


def test_first_is_one_attempt_from_the_seed(puma):
    first = {"target": target(), "mode": SolveIK.Request.FIRST}
    near = solve_ik(puma, seed=joint_state((), Q + 0.1), **first)
    assert (near.error_code, near.complete) == (ErrorCode.NONE, False)
    np.testing.assert_allclose(positions(near), [Q], atol=1e-6)
    assert max(near.position_errors) < 1e-9 and max(near.orientation_errors) < 1e-8
    far = target()
    far.pose.position.x += 5.0
    lost = solve_ik(puma, target=far, seed=joint_state((), Q), mode=SolveIK.Request.FIRST)
    assert (lost.error_code, len(lost.solutions)) == (ErrorCode.NOT_CONVERGED, 0)
    assert lost.error_msg.startswith("the attempt from the seed ended ")


def test_metric_changes_the_distances(puma):
    options = {"target": target(), "seed": joint_state((), 0.9 * Q), "ignore_limits": True}
    largest = solve_ik(puma, **options)
    squares = solve_ik(puma, **options, metric=SolveIK.Request.L2)
    for response, norm in ((largest, np.inf), (squares, 2)):
        expected = np.linalg.norm(positions(response) - 0.9 * Q, ord=norm, axis=1)
        np.testing.assert_allclose(response.seed_distances, expected, atol=1e-9)


def test_windings_are_listed_on_request(graph):
    graph.start(KinematicsNode, robot_description="ur5e")
    chain = load_robot("ur5e")
    q = np.array([0.3, -1.0, 1.2, 0.4, 0.9, -0.5])
    options = {"target": target(q, chain), "seed": joint_state((), q)}
    once, wound = solve_ik(graph, **options), solve_ik(graph, **options, include_windings=True)
    assert len(once.solutions) == 8
    assert once.family == "three-parallel"
    assert len(wound.solutions) > len(once.solutions)
    assert np.all(positions(wound) >= chain.lower)
    assert np.all(positions(wound) <= chain.upper)


def test_same_request_same_answer(puma):
    first, second = (solve_ik(puma, target=target(), seed=joint_state((), Q)) for _ in range(2))
    first.solve_time = second.solve_time
    assert first == second


def test_an_empty_seed_is_the_present_state_else_the_mid_range(own_puma):
    middle = solve_ik(own_puma, target=target(), ignore_limits=True)
    expected = np.abs(positions(middle) - PUMA.midrange()).max(axis=1)
    np.testing.assert_allclose(middle.seed_distances, expected, atol=1e-9)
    publish_present(own_puma, 0.9 * Q, PUMA.joint_names)
    near = solve_ik(own_puma, target=target(), ignore_limits=True)
    np.testing.assert_allclose(
        near.seed_distances, np.abs(positions(near) - 0.9 * Q).max(axis=1), atol=1e-9
    )
    poses = solve_fk(own_puma).poses
    np.testing.assert_allclose(
        matrix_from_pose(poses[0].pose), forward_kinematics(PUMA, 0.9 * Q), atol=1e-12
    )


def test_present_state_beyond_a_limit_is_no_error(own_puma):
    publish_present(own_puma, PUMA.upper + 1e-3, PUMA.joint_names)
    assert solve_ik(own_puma, target=target()).error_code == 0


def test_target_in_a_frame_fixed_to_the_base(graph):
    graph.start(KinematicsNode, robot_description="ur5e", base_link="base_link_inertia")
    description = load_description("ur5e")
    chain = description.chain("base_link_inertia")
    q = np.array([0.3, -1.0, 1.2, 0.4, 0.9, -0.5])
    above = description.chain("base_link")
    response = solve_ik(graph, target=target(q, above, frame="base_link"), seed=joint_state((), q))
    assert response.error_code == 0, response.error_msg
    np.testing.assert_allclose(positions(response)[0], q, atol=1e-8)
    same = solve_ik(graph, target=target(q, chain), seed=joint_state((), q))
    # One joint is half a turn from its seed: rounding decides to which side.
    apart = np.exp(1j * (positions(response) - positions(same)))
    np.testing.assert_allclose(apart, 1.0, atol=1e-8)


def test_another_tip(graph):
    graph.start(KinematicsNode, robot_description="ur5e")
    chain = load_description("ur5e").chain(None, "wrist_3_link")
    q = np.array([0.3, -1.0, 1.2, 0.4, 0.9, -0.5])
    response = solve_ik(
        graph, target=target(q, chain), tip_link="wrist_3_link", seed=joint_state((), q)
    )
    assert response.error_code == 0
    np.testing.assert_allclose(positions(response)[0], q, atol=1e-8)


def test_task_mask(graph):
    graph.start(KinematicsNode, robot_description="planar3r")
    chain = load_robot("planar3r")
    wanted = target(np.array([0.4, 0.5, 0.6]), chain)
    wanted.pose.position.z = 0.5
    mask = [True, True, False, False, False, True]
    refused = solve_ik(graph, target=wanted)
    assert refused.error_code in (ErrorCode.OUT_OF_REACH, ErrorCode.NOT_CONVERGED)
    response = solve_ik(graph, target=wanted, task_mask=mask)
    assert response.error_code == 0, response.error_msg
    for q in positions(response):
        reached = forward_kinematics(chain, q)
        np.testing.assert_allclose(
            reached[:2, 3], (wanted.pose.position.x, wanted.pose.position.y), atol=1e-6
        )


def test_batch_agrees_with_single_calls(puma):
    rng = np.random.default_rng(3)
    q = rng.uniform(PUMA.lower, PUMA.upper, (20, 6))
    T = forward_kinematics(PUMA, q)
    T[7, :3, 3] = (5.0, 0.0, 0.0)
    rows = []
    for pose in (stamped_pose(t, "").pose for t in T):
        p, o = pose.position, pose.orientation
        rows += [p.x, p.y, p.z, o.x, o.y, o.z, o.w]
    request = SolveIKBatch.Request(poses=rows, seed=Q.tolist())
    response = puma.call(SolveIKBatch, "kinematics/solve_ik_batch", request)
    assert response.error_code == 0
    assert response.joint_names == list(PUMA.joint_names)
    solutions = np.array(response.solutions).reshape(-1, 6)
    assert len(solutions) == sum(response.counts) == len(response.position_errors)
    starts = np.cumsum([0, *response.counts])
    for i, t in enumerate(T):
        single = inverse_kinematics(PUMA, t, seed=Q)
        assert response.codes[i] == int(single.status)
        mine = solutions[starts[i] : starts[i + 1]]
        assert mine.shape == single.q.shape
        np.testing.assert_allclose(mine, single.q, atol=1e-8)
    assert response.codes[7] == ErrorCode.OUT_OF_REACH
    assert max(response.position_errors) < 1e-9
    assert max(response.orientation_errors) < 1e-8
    request.mode = SolveIKBatch.Request.NEAREST
    nearest = puma.call(SolveIKBatch, "kinematics/solve_ik_batch", request)
    assert list(nearest.counts) == [min(count, 1) for count in response.counts]
    first = solutions[[s for s, c in zip(starts, response.counts, strict=False) if c]]
    np.testing.assert_array_equal(np.array(nearest.solutions).reshape(-1, 6), first)


def test_empty_batch(puma):
    response = puma.ask(SolveIKBatch, "kinematics/solve_ik_batch")
    assert response.error_code == 0
    assert list(response.counts) == list(response.solutions) == list(response.codes) == []


def matrix(response):
    return np.array(response.jacobian).reshape(6, -1)


def test_jacobian_has_linear_rows_first(puma):
    response = get_jacobian(puma, state=joint_state(PUMA.joint_names, Q))
    assert response.error_code == 0
    assert response.joint_names == list(PUMA.joint_names)
    J = jacobian(PUMA, Q)
    np.testing.assert_allclose(matrix(response), np.vstack((J[3:], J[:3])), atol=1e-14)


def test_jacobian_of_a_point_in_the_axes_of_the_tip(puma):
    point = np.array([0.1, -0.2, 0.3])
    response = get_jacobian(
        puma,
        state=joint_state((), Q),
        reference_frame="tool0",
        tool_point=Point(x=0.1, y=-0.2, z=0.3),
    )
    assert response.error_code == 0, response.error_msg
    T = forward_kinematics(PUMA, Q)
    step = 1e-6
    numeric = np.empty((3, 6))
    for i in range(6):
        ends = [
            forward_kinematics(PUMA, Q + sign * step * np.eye(6)[i])[:3] @ (*point, 1.0)
            for sign in (1, -1)
        ]
        numeric[:, i] = T[:3, :3].T @ (ends[0] - ends[1]) / (2 * step)
    np.testing.assert_allclose(matrix(response)[:3], numeric, atol=1e-8)
    np.testing.assert_allclose(
        matrix(response)[3:], T[:3, :3].T @ jacobian(PUMA, Q)[:3], atol=1e-14
    )


def test_jacobian_of_a_link_on_the_way(puma):
    link = PUMA.links[3]
    response = get_jacobian(puma, state=joint_state((), Q[:3]), tip_link=link)
    assert response.error_code == 0, response.error_msg
    assert response.joint_names == list(PUMA.joint_names[:3])
    J = jacobian(PUMA.with_tip(link), Q[:3])
    np.testing.assert_allclose(matrix(response), np.vstack((J[3:], J[:3])), atol=1e-14)


@pytest.mark.parametrize("given", [Q, Q[:3]], ids=["all joints", "those up to the link"])
def test_states_without_names_mean_the_same_in_every_service(puma, given):
    link = PUMA.links[3]
    chain, state = PUMA.with_tip(link), joint_state((), given)
    fk = solve_fk(puma, states=[state], links=[link])
    assert fk.error_code == 0, fk.error_msg
    T = forward_kinematics(chain, Q[:3])
    np.testing.assert_allclose(matrix_from_pose(fk.poses[0].pose), T, atol=1e-14)
    J = jacobian(chain, Q[:3])
    response = get_jacobian(puma, state=state, tip_link=link)
    assert response.error_code == 0, response.error_msg
    np.testing.assert_allclose(matrix(response), np.vstack((J[3:], J[:3])), atol=1e-14)
    ik = solve_ik(puma, target=fk.poses[0], seed=state, tip_link=link)
    assert ik.error_code == 0, ik.error_msg
    np.testing.assert_allclose(positions(ik)[0], Q[:3], atol=1e-6)
    for answer in (
        solve_fk(puma, states=[joint_state((), Q[:4])], links=[link]),
        get_jacobian(puma, state=joint_state((), Q[:4]), tip_link=link),
        solve_ik(puma, target=fk.poses[0], seed=joint_state((), Q[:4]), tip_link=link),
    ):
        assert answer.error_code == ErrorCode.WRONG_SIZE
        assert "position has size 4, expected 6 for waist" in answer.error_msg
        assert "or 3 for the joints up to link 'link_3'" in answer.error_msg


def analyze(graph, **fields):
    return graph.ask(AnalyzeSingularity, "kinematics/analyze_singularity", **fields)


def test_a_singular_posture_is_analysed(puma):
    q = np.array([0.3, -0.4, 0.2, 0.5, 0.0, -0.7])
    response = analyze(puma, state=joint_state((), q), reference_frame="tool0")
    assert (response.error_code, response.error_msg) == (0, "")
    assert response.singularity_types == ["wrist"] and response.rank == 5
    assert response.summary == "singular (wrist): rank 5, 1 direction of motion lost"
    assert response.characteristic_length == characteristic_length(PUMA)
    assert np.isinf([response.condition_number, response.normalised_condition_number]).all()
    (lost,) = response.lost_directions
    assert lost.header.frame_id == "tool0"
    rows = get_jacobian(puma, state=joint_state((), q), reference_frame="tool0")
    scale = 1.0 / response.characteristic_length
    twist = lost.twist
    normal = np.array([getattr(twist.linear, axis) * scale for axis in "xyz"] +
                      [getattr(twist.angular, axis) for axis in "xyz"])  # fmt: skip
    assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
    J = matrix(rows) * np.repeat((scale, 1.0), 3)[:, None]
    np.testing.assert_allclose(normal @ J, 0.0, atol=1e-9)


def test_a_regular_posture_is_analysed_at_a_point(puma):
    point = Point(x=0.1, y=-0.2, z=0.3)
    response = analyze(puma, state=joint_state((), Q), tool_point=point)
    assert (response.error_code, response.error_msg) == (0, "")
    report = singularity_report(PUMA, Q, point=[0.1, -0.2, 0.3])
    np.testing.assert_allclose(response.singular_values, report.singular_values, rtol=1e-12)
    assert response.manipulability == pytest.approx(report.manipulability, rel=1e-9)
    assert response.condition_number == pytest.approx(report.condition_number, rel=1e-9)
    assert response.singularity_types == [] and response.lost_directions == []
    assert response.summary.startswith("regular: rank 6, least singular value ")


@pytest.mark.parametrize(
    ("fields", "code", "text"),
    [
        ({"state": joint_state((), Q[:5])}, ErrorCode.WRONG_SIZE, "position has size 5"),
        ({"tip_link": "no"}, ErrorCode.UNKNOWN_LINK, "'no'"),
        ({"state": joint_state((), Q), "reference_frame": "no"}, ErrorCode.FRAME_UNAVAILABLE, "no"),
        (
            {"state": joint_state((), Q), "tool_point": Point(x=np.nan)},
            ErrorCode.NON_FINITE,
            "tool",
        ),
        ({"state": joint_state((), Q * np.inf)}, ErrorCode.NON_FINITE, "waist"),
    ],
)
def test_analyze_singularity_refuses(puma, fields, code, text):
    response = analyze(puma, **({"state": joint_state((), Q)} | fields))
    assert response.error_code == code and text in response.error_msg


def test_the_present_state_is_waited_for_while_others_are_served(graph):
    graph.start(KinematicsNode, robot_description="puma560", state_timeout=30.0)
    waiting = [
        graph.start_call(SolveFK, "kinematics/solve_fk", SolveFK.Request()),
        graph.start_call(GetJacobian, "kinematics/get_jacobian", GetJacobian.Request()),
    ]
    assert solve_fk(graph, states=[joint_state((), Q)]).error_code == ErrorCode.NONE
    assert solve_ik(graph, target=target()).error_code == ErrorCode.NONE
    assert not any(future.done() for future in waiting)
    publish_present(graph, Q, PUMA.joint_names)
    for future in waiting:
        answer = graph.wait_for(future)
        assert answer.error_code == ErrorCode.NONE, answer.error_msg


def unreachable(count):
    return [4.0, 0.1, 0.3, 0.0, 0.0, 0.0, 1.0] * count


def test_others_are_served_while_a_batch_is_solved(graph):
    graph.start(KinematicsNode, robot_description="panda")
    request = SolveIKBatch.Request(poses=unreachable(10_000))
    batch = graph.start_call(SolveIKBatch, "kinematics/solve_ik_batch", request)
    state = joint_state((), load_robot("panda").midrange())
    for _ in range(3):
        assert solve_fk(graph, states=[state]).error_code == ErrorCode.NONE
    # Ten thousand poses out of its reach take minutes.
    assert not batch.done()


@pytest.mark.parametrize("robot", ["panda", "puma560"])
def test_a_batch_ends_in_its_time_and_says_what_is_left(graph, robot):
    graph.start(KinematicsNode, robot_description=robot, batch_timeout=0.3)
    chain = load_robot(robot)
    p = stamped_pose(forward_kinematics(chain, chain.midrange()), "").pose
    row = [p.position.x, p.position.y, p.position.z]
    row += [p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w]
    response = graph.ask(SolveIKBatch, "kinematics/solve_ik_batch", poses=row + unreachable(9_999))
    assert response.error_code == ErrorCode.TIMED_OUT
    codes = list(response.codes)
    assert len(codes) == len(response.counts) == 10_000
    left = codes.count(ErrorCode.TIMED_OUT)
    assert 0 < left < 10_000
    assert set(codes[-left:]) == {ErrorCode.TIMED_OUT}
    assert set(codes[1:-left]) <= {ErrorCode.OUT_OF_REACH}
    assert f"{10000 - left} of 10000 poses solved in 0.3 s" in response.error_msg
    assert "batch_timeout" in response.error_msg
    assert response.counts[0] >= 1
    assert len(response.solutions) == sum(response.counts) * chain.n


def test_robot_from_the_topic(graph):
    graph.start(KinematicsNode, tip_link="wrist_3_link")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = graph.client.create_publisher(String, "robot_description", latched)
    publisher.publish(String(data="<robot>"))
    with open(load_description("ur5e").where, encoding="utf-8") as file:
        publisher.publish(String(data=file.read()))
    chain = load_description("ur5e").chain(None, "wrist_3_link")
    q = np.array([0.3, -1.0, 1.2, 0.4, 0.9, -0.5])
    response = solve_fk(graph, states=[joint_state(chain.joint_names, q)])
    assert response.error_code == 0
    np.testing.assert_allclose(
        matrix_from_pose(response.poses[0].pose), forward_kinematics(chain, q), atol=1e-12
    )


def test_namespace(graph):
    graph.start(KinematicsNode, namespace="/left", robot_description="puma560")
    assert graph.ask(SolveIK, "/left/kinematics/solve_ik", target=target()).error_code == 0


def test_an_earlier_name_of_a_parameter_is_answered_with_the_present_one(graph, capfd):
    graph.start(KinematicsNode, robot_description="puma560", frame_age=5.0)
    said = capfd.readouterr().err
    assert "parameter 'frame_age' is ignored: its name here is 'max_transform_age'" in said
