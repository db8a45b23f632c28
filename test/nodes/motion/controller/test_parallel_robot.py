"""Simulated parallel robots: trajectories move the drives, and all joints close the loops."""

import numpy as np
import pytest
from drivers import NAME, TIMEOUT, PlatformDriver
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from robomech_interfaces.msg import ErrorCode
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.parallel import list_parallel, load_parallel, load_tree_description

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
CLOSED = 1e-10


def step(mechanism, size):
    """Return a small change of the drives, within their strokes."""
    home = mechanism.home()[mechanism.drive_index]
    lower, upper = (row[mechanism.drive_index] for row in (mechanism.lower, mechanism.upper))
    middle = np.where(np.isfinite(lower + upper), (lower + upper) / 2.0, home)
    return np.where(middle >= home, 1.0, -1.0) * size * np.linspace(0.5, 1.0, mechanism.dof)


@pytest.mark.parametrize("name", list_parallel())
def test_every_state_closes_all_loops_with_velocities_that_fit(platform, name):
    robot = platform(name)
    mechanism = robot.mechanism
    assert tuple(robot.states[-1].name) == mechanism.joint_names
    change = step(mechanism, 0.02)
    _, result = robot.execute(robot.move((0.6, change), (1.2, -change)))
    assert result.error_code == ErrorCode.NONE, result.error_msg
    _, positions, velocities = robot.path()
    assert mechanism.loop_errors(positions).max() < CLOSED
    index = mechanism.drive_index
    assert np.abs(velocities[:, index]).max() > 0.0
    expected, _ = mechanism.rates(positions, velocities[:, index])
    np.testing.assert_allclose(velocities, expected, atol=1e-9)


@pytest.mark.parametrize("name", ["hexapod", "delta"])
def test_velocities_are_the_differences_of_positions(platform, name):
    size, duration = 0.02, 0.5
    robot = platform(name, publish_rate=500.0)
    _, result = robot.execute(robot.move((duration, step(robot.mechanism, size))))
    assert result.error_code == ErrorCode.NONE, result.error_msg
    times, positions, velocities = robot.path()
    spans = np.diff(times)[:, None]
    way, mean = np.diff(positions, axis=0), (velocities[:-1] + velocities[1:]) / 2.0
    # The error of the trapezoidal rule is the jerk times span^3 / 12: that of a drive is up to
    # 60 size / duration^3, and of joints that follow some times that.
    jerk = 20.0 * 60.0 * size / duration**3
    assert (np.abs(way - mean * spans) <= jerk * spans**3 / 12.0 + 1e-9).all()
    assert np.abs(way).max() > 0.0


def test_trajectories_may_name_passive_joints_that_agree(platform):
    robot = platform("delta")
    mechanism = robot.mechanism
    begin = robot.position
    end = mechanism.close(robot.drives + 0.1, begin).q
    message = robot.move((0.5, np.zeros(3)))
    message.joint_names = list(mechanism.joint_names)
    still = [0.0] * mechanism.n
    for point, q in zip(message.points, (begin, end), strict=True):
        point.positions, point.velocities, point.accelerations = q.tolist(), still, still
    _, result = robot.execute(message)
    assert result.error_code == ErrorCode.NONE, result.error_msg
    np.testing.assert_allclose(robot.position, end, atol=1e-9)


@pytest.mark.parametrize(("row", "text"), [(0, "another assembly mode"), (1, "points[1]")])
def test_passive_joints_that_disagree_are_refused(platform, row, text):
    robot = platform("delta")
    mechanism = robot.mechanism
    message = robot.move((0.5, np.full(3, 0.1)))
    passive = mechanism.joint_names.index("leg2_elbow_tilt")
    message.joint_names = [*message.joint_names, "leg2_elbow_tilt"]
    end = mechanism.close(robot.drives + 0.1, robot.position).q
    for point, q in zip(message.points, (robot.position, end), strict=True):
        point.positions = [*point.positions, q[passive]]
        point.velocities = point.accelerations = [0.0] * 4
    message.points[row].positions[-1] += 0.3
    _, result = robot.execute(message)
    assert result.error_code == ErrorCode.REJECTED
    assert "joint 'leg2_elbow_tilt' is passive" in result.error_msg
    assert text in result.error_msg
    assert not robot.velocity.any()


def singular_way(mechanism):
    """Find a change of the drives on whose straight way the assembly mode ends."""
    home = mechanism.home()
    drives = home[mechanism.drive_index]
    random = np.random.default_rng(5)
    for _ in range(200):
        change = random.uniform(-1.5, 1.5, mechanism.dof)
        inside = (drives + change > mechanism.lower[mechanism.drive_index]) & (
            drives + change < mechanism.upper[mechanism.drive_index]
        )
        closed = mechanism.close(drives + change, home)
        if inside.all() and closed.status and 0.2 < closed.part < 0.8:
            return change, closed.part
    raise AssertionError("no way crosses a singularity")


def test_trajectories_across_a_singularity_are_refused_with_the_point_before(platform):
    robot = platform("planar_3rrr")
    change, part = singular_way(robot.mechanism)
    points = [(0.5 * k, change * k / 4) for k in range(1, 5)]
    _, result = robot.execute(robot.move(*points, velocities=False))
    assert result.error_code == ErrorCode.SINGULAR
    assert f"after points[{int(part * 4)}] of 4" in result.error_msg
    assert "singularity" in result.error_msg
    assert not robot.velocity.any()
    # It is as ready as before.
    _, result = robot.execute(robot.move((0.5, 0.05 * change)))
    assert result.error_code == ErrorCode.NONE, result.error_msg


def test_lengths_outside_the_strokes_are_refused_with_the_leg(platform):
    robot = platform("hexapod")
    change = np.zeros(6)
    change[2] = 0.8
    _, result = robot.execute(robot.move((1.0, change)))
    # A singularity is in the way, too, but that is not what is wrong with the request.
    assert result.error_code == ErrorCode.LIMIT
    assert "points[1]: position of joint 'leg3_length' is" in result.error_msg
    assert "over its limit 0.95 m by" in result.error_msg


def test_a_trajectory_of_one_point_says_that_it_cannot_be_followed_to_it(platform):
    robot = platform("planar_3rrr")
    message = robot.move((2.0, singular_way(robot.mechanism)[0]), velocities=False)
    message.points = message.points[-1:]
    _, result = robot.execute(message)
    assert result.error_code == ErrorCode.SINGULAR
    assert "the trajectory cannot be followed to points[0]: a singularity" in result.error_msg


@pytest.mark.parametrize("drives", [0, 2])
def test_passive_joints_without_all_drives_are_told_so(platform, drives):
    robot = platform("delta")
    message = robot.move((0.5, np.zeros(3)))
    message.joint_names = [*message.joint_names[:drives], "leg2_elbow_tilt"]
    for point in message.points:
        point.positions, point.velocities, point.accelerations = [0.0] * (drives + 1), [], []
    _, result = robot.execute(message)
    assert result.error_code == ErrorCode.WRONG_SIZE
    assert "all drives, beside which passive joints as 'leg2_elbow_tilt'" in result.error_msg
    assert result.error_msg.endswith("leg3_base")


def test_reset_and_holds_keep_the_loops_closed(platform, graph):
    robot = platform("hexapod")
    home = robot.position
    handle = robot.send(robot.move((3.0, step(robot.mechanism, 0.05))))
    robot.until_moving()
    assert graph.call(Trigger, f"{NAME}/hold", Trigger.Request()).success
    _, result = robot.result(handle)
    assert result.error_code == ErrorCode.PREEMPTED
    assert graph.call(Trigger, f"{NAME}/reset", Trigger.Request()).success
    robot.until_at(home)
    _, positions, _ = robot.path()
    assert robot.mechanism.loop_errors(positions).max() < CLOSED


def test_initial_positions_of_drives_or_of_all_joints(platform):
    mechanism = load_parallel("hexapod").mechanism
    home = mechanism.home()
    lengths = home[mechanism.drive_index] + 0.02
    robot = platform("hexapod", initial_positions=lengths.tolist())
    np.testing.assert_allclose(robot.drives, lengths, atol=1e-12)
    assert mechanism.loop_errors(robot.position).max() < CLOSED


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"initial_positions": [0.7, 0.7]}, "6, of the drives, or 36, of all joints"),
        ({"initial_positions": [2.0] * 6}, "0.6 to 0.95 m, the stroke"),
        ({"initial_positions": [0.01, 3.0, 0.01, 0.01, 0.01, 0.01]}, "initial_positions"),
    ],
)
def test_parameters_that_do_not_fit_a_parallel_robot(graph, parameters, text):
    with pytest.raises(ParameterError, match=text):
        graph.start(JointTrajectoryControllerNode, robot_description="hexapod", **parameters)


def test_tree_and_loops_come_by_the_topic(platform, graph):
    robot = platform("delta")
    message = graph.receive(String, "robot_description", LATCHED, lambda message: True)
    again = load_tree_description(message.data)
    assert again.mechanism.joint_names == robot.mechanism.joint_names
    np.testing.assert_allclose(
        again.mechanism.pose(robot.position), robot.mechanism.pose(robot.position)
    )


def test_a_stuck_drive_ends_the_motion_before_the_singularity(platform):
    # With all drives the way is regular; with the first one stuck a singular posture is in it.
    change = np.array([-1.0195, 1.6647, -0.4024])
    robot = platform("planar_3rrr", fault_stuck_joints="leg1_base")
    mechanism, home = robot.mechanism, robot.position
    held = mechanism.close(robot.drives + change * [0.0, 1.0, 1.0], home)
    assert held.status == ErrorCode.SINGULAR and 0.2 < held.part < 0.8
    _, result = robot.execute(robot.move((3.0, change)))
    assert result.error_code == ErrorCode.SINGULAR
    assert "stopped before a singular posture" in result.error_msg
    robot.until(lambda: not robot.velocity.any())
    _, positions, _ = robot.path()
    assert mechanism.loop_errors(positions).max() < CLOSED
    # The robot stands where it was before, and has left its start.
    assert np.abs(robot.position - home).max() > 0.01


@pytest.mark.slow
def test_a_robot_whose_process_was_killed_begins_at_home(graph, process):
    started = []

    def start(node, **parameters):
        started.append(process(node, **parameters))

    robot = PlatformDriver(graph, start, robot_description="hexapod")
    robot.execute(robot.move((0.5, step(robot.mechanism, 0.02))))
    robot.until(lambda: not robot.velocity.any())
    assert np.abs(robot.position - robot.mechanism.home()).max() > 0.005
    started[0].kill()
    started[0].wait(TIMEOUT)
    robot.states.clear()
    start(JointTrajectoryControllerNode, robot_description="hexapod")
    robot.until(lambda: robot.states)
    np.testing.assert_allclose(robot.position, robot.mechanism.home(), atol=1e-9)
