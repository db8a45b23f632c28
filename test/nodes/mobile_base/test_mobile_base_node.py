"""The node of mobile bases: topics, frames, time-outs and what it ignores, over real DDS."""

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage
from twist_driver import Driver

from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.mobile_base.node import MobileBaseNode
from robomech_ros.rolling import load_rolling, rolling_robot

FAST = {"update_rate": 50.0}
BICYCLE = {
    "drive": "bicycle",
    "traction_joints_names": ["rear"],
    "steering_joints_names": ["front"],
    "wheelbase": 1.2,
    "traction_wheels_radius": 0.15,
}


def speed(message):
    return message.twist.twist.linear.x


@pytest.mark.parametrize(
    ("robot", "command", "odometry"),
    [
        ("differential", "cmd_vel", "odom"),
        ("omni", "cmd_vel", "odom"),
        ("swerve", "cmd_vel", "odom"),
        ("mecanum", "reference", "odometry"),
        ("tricycle", "reference", "odometry"),
        ("ackermann", "reference", "odometry"),
    ],
)
def test_every_drive_follows_its_topic_brakes_and_follows_again(graph, robot, command, odometry):
    # 3: a mecanum base has no time-out by default.
    graph.start(MobileBaseNode, robot_description=robot, reference_timeout=0.5, **FAST)
    topic = f"mobile_base/{odometry}"
    driver = Driver(graph, f"mobile_base/{command}")
    for _ in range(2):
        driver.command(0.3)
        moving = graph.receive(Odometry, topic, 10, lambda m: abs(speed(m) - 0.3) < 1e-6)
        assert moving.pose.pose.position.x > 0.0
        driver.silent()
        graph.receive(Odometry, topic, 10, lambda m: speed(m) == 0.0)
    truth = graph.receive(PoseStamped, "mobile_base/simulated_base", 10, lambda m: True)
    last = graph.receive(Odometry, topic, 10, lambda m: True)
    assert abs(truth.pose.position.x - last.pose.pose.position.x) < 1e-9
    # Covariance has grown with the way.
    assert last.pose.covariance[0] > 0.0 and last.pose.covariance[35] > 0.0


@pytest.mark.parametrize(("robot", "command"), [("tricycle", "reference"), ("swerve", "cmd_vel")])
def test_motors_drive_and_steer_within_their_torques_and_joint_states_show_them(
    graph, robot, command
):
    # On a busy machine commands may be late.
    late = {"reference_timeout": 60.0, "cmd_vel_timeout": 60.0, "update_rate": 20.0}
    graph.start(MobileBaseNode, robot_description=robot, simulation="dynamic", **late)
    dynamics, largest = rolling_robot(robot).dynamics, {}

    def heard(message):
        for name, effort in zip(message.name, message.effort, strict=True):
            largest[name] = max(abs(effort), largest.get(name, 0.0))

    graph.client.create_subscription(JointState, "joint_states", heard, 100)
    Driver(graph, f"mobile_base/{command}").command(0.3, 0.0, 0.2)
    topic = f"mobile_base/{'odom' if robot == 'swerve' else 'odometry'}"
    graph.receive(Odometry, topic, 20, lambda m: abs(m.twist.twist.angular.z - 0.2) < 1e-4)
    for name, limit in zip(dynamics.motors, dynamics.max_torques, strict=True):
        assert 0.0 < largest[name] <= limit * (1.0 + 1e-12)
    assert all(largest[name] == 0.0 for name in {*largest} - {*dynamics.motors})


def test_wheels_have_the_rates_of_the_limited_command(graph):
    parameters = {"publish_limited_velocity": True, "reference_timeout": 1.0, **FAST}
    graph.start(MobileBaseNode, robot_description="mecanum", **parameters)
    driver = Driver(graph, "mobile_base/reference_unstamped", stamped=False)
    driver.command(0.3, 0.1, 0.2)
    # 11: what is sent out is what the wheels got.
    limited = graph.receive(
        TwistStamped, "mobile_base/cmd_vel_out", 10, lambda m: abs(m.twist.linear.x - 0.3) < 1e-9
    )
    base = load_rolling("mecanum")
    twist = limited.twist
    rates = base.wheel_rates([twist.angular.z, twist.linear.x, twist.linear.y])
    graph.receive(
        Float64MultiArray,
        "mobile_base/commands",
        10,
        lambda m: np.abs(np.array(m.data) - rates).max() < 1e-6,
    )
    states = graph.receive(
        JointState, "joint_states", 10, lambda m: np.abs(m.velocity - rates).max() < 1e-6
    )
    assert tuple(states.name) == base.names and min(states.position) > 0.0


def test_the_joint_states_have_the_brackets_of_casters_too(graph):
    """Without them neither RViz nor the view would know where a caster is."""
    node = graph.start(MobileBaseNode, robot_description="differential", **FAST)
    Driver(graph, "mobile_base/cmd_vel").command(0.3, 0.0, 0.6)
    settled = graph.receive(
        JointState,
        "joint_states",
        10,
        lambda m: abs(m.position[3]) > 0.3 and abs(m.velocity[3]) < 1e-6,
    )
    assert settled.name == ["left", "right", "caster", "caster_bracket"]
    # Settled on the circle, it does not turn any more beside the base.
    base = node._base.robot.base
    assert base.caster_rates([0.6, 0.3, 0.0], settled.position[3:])[0] == pytest.approx(0, abs=1e-5)


def test_frames_have_the_namespace_and_covariances_those_of_the_parameters(graph):
    diagonal = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    graph.start(
        MobileBaseNode,
        namespace="left",
        robot_description="differential",
        pose_covariance_diagonal=diagonal,
        twist_covariance_diagonal=diagonal,
        **FAST,
    )
    message = graph.receive(Odometry, "/left/mobile_base/odom", 10, lambda m: True)
    assert (message.header.frame_id, message.child_frame_id) == ("left/odom", "left/base_link")
    for covariance in (message.pose.covariance, message.twist.covariance):
        np.testing.assert_array_equal(np.reshape(covariance, (6, 6)), np.diag(diagonal))
    # Those of wheels come by themselves.
    frames = graph.receive(
        TFMessage, "/tf", 100, lambda m: m.transforms[0].child_frame_id == "left/base_link"
    )
    (frame,) = frames.transforms
    assert frame.header.frame_id == "left/odom"


@pytest.mark.parametrize(
    ("given", "prefix"),
    [
        ({"tf_frame_prefix": "cell"}, "cell/"),
        ({"tf_frame_prefix": "~"}, "left/"),
        ({"tf_frame_prefix_enable": False}, ""),
    ],
)
def test_the_prefix_of_frames(graph, given, prefix):
    graph.start(
        MobileBaseNode,
        namespace="left",
        robot_description="differential",
        enable_odom_tf=False,
        **given,
    )
    message = graph.receive(Odometry, "/left/mobile_base/odom", 10, lambda m: True)
    assert message.header.frame_id == f"{prefix}odom"
    # 8: no frames where none are wanted.
    assert not graph.client.get_publishers_info_by_topic("/tf")


@pytest.mark.parametrize("wanted", [True, False])
@pytest.mark.parametrize("drive", INTERFACES)
def test_no_drive_has_frames_where_none_are_wanted(graph, drive, wanted):
    # Asked of the node itself: from outside a publisher may be there and not be found yet.
    names = {"diff": "differential"}
    robot = BICYCLE if drive == "bicycle" else {"robot_description": names.get(drive, drive)}
    node = graph.start(MobileBaseNode, enable_odom_tf=wanted, **robot)
    found = [one.topic_name for one in node.publishers if one.msg_type is TFMessage]
    topic = INTERFACES[drive].frames.replace("~", "/mobile_base")
    # Then the frames of the wheels.
    assert found == ([topic, "/tf", "/tf_static"] if wanted else [])


@pytest.mark.parametrize(
    ("old", "value", "text"),
    [(1, 0.3, "age of the command"), (None, math.nan, "command"), (None, math.inf, "command")],
)
def test_what_is_ignored_is_said_and_moves_nothing(graph, old, value, text):
    graph.start(MobileBaseNode, robot_description="differential", **FAST)
    Driver(graph, "mobile_base/cmd_vel", old=old).command(value)

    def ignored(message):
        values = {one.key: one.value for one in message.status[0].values}
        return text in values["last ignored"] and message.status[0].level == b"\x01"

    graph.receive(DiagnosticArray, "/diagnostics", 10, ignored)
    message = graph.receive(Odometry, "mobile_base/odom", 10, lambda m: True)
    assert speed(message) == 0.0 and message.pose.pose.position.x == 0.0


def test_a_stamp_of_zero_is_now(graph):
    graph.start(MobileBaseNode, robot_description="differential", **FAST)
    Driver(graph, "mobile_base/cmd_vel", old=0).command(0.3)
    graph.receive(Odometry, "mobile_base/odom", 10, lambda m: speed(m) > 0.1)


def test_odometry_is_reset_while_the_base_moves_on(graph):
    graph.start(MobileBaseNode, robot_description="differential", **FAST)
    Driver(graph, "mobile_base/cmd_vel").command(0.5)
    far = graph.receive(
        Odometry, "mobile_base/odom", 10, lambda m: m.pose.pose.position.x > 1.0
    ).pose.pose.position.x
    graph.call(Empty, "mobile_base/reset_odometry", Empty.Request())
    after = graph.receive(Odometry, "mobile_base/odom", 10, lambda m: m.pose.pose.position.x < far)
    assert speed(after) > 0.4


def test_odometry_goes_on_where_it_is_set(graph):
    SetOdometry = pytest.importorskip("control_msgs.srv").SetOdometry
    graph.start(MobileBaseNode, robot_description="differential", **FAST)

    def ask(**fields):
        answer = graph.call(SetOdometry, "mobile_base/set_odometry", SetOdometry.Request(**fields))
        return answer.success, answer.message

    assert ask(x=3.0, y=-2.0, yaw=1.0) == (True, "odometry continues at x, y and yaw")
    told = graph.receive(Odometry, "mobile_base/odom", 10, lambda m: m.pose.pose.position.x == 3.0)
    at = told.pose.pose
    assert (at.position.y, at.orientation.z) == (-2.0, math.sin(0.5))
    assert min(told.pose.covariance[::7]) > 0.0 and min(told.twist.covariance[::7]) > 0.0
    success, text = ask(yaw=math.nan)
    assert not success and "odometry.yaw is nan" in text
    assert "z, roll and pitch were ignored" in ask(z=1.0)[1]


def test_a_robot_may_be_made_from_parameters(graph):
    graph.start(
        MobileBaseNode,
        drive="diff",
        left_wheel_names=["a", "b"],
        right_wheel_names=["c", "d"],
        wheel_separation=0.4,
        wheel_radius=0.1,
        initial_wheel_position=5.0,
        **{"linear.x.max_velocity": 0.2, "linear.x.max_acceleration": 1.0},
    )
    Driver(graph, "mobile_base/cmd_vel").command(0.5)
    states = graph.receive(
        JointState, "joint_states", 10, lambda m: abs(m.velocity[0] - 2.0) < 1e-9
    )
    assert list(states.name) == ["a", "b", "c", "d"] and min(states.position) > 5.0
    status = graph.receive(
        DiagnosticArray, "/diagnostics", 10, lambda m: "linear.x" in m.status[0].message
    )
    assert status.status[0].hardware_id == "diff"


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({}, "'drive' is ''; allowed is one of diff"),
        ({"robot_description": "differential", "linear.x.max_jerk": -1.0}, r"'linear.x.max_jerk'"),
        ({"drive": "sledge"}, "'drive' is 'sledge'"),
    ],
)
def test_parameters_that_make_no_base_are_refused_at_the_start(graph, given, text):
    with pytest.raises(ParameterError, match=text):
        graph.start(MobileBaseNode, **given)
