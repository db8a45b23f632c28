"""A rolling robot that is brought up, driven and watched across processes."""

import threading

import numpy as np
import pinocchio
import pytest
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from robomech_ros.spatial import matrix_from_quaternion

PATIENCE = 60.0
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_a_mecanum_base_is_brought_up_and_driven(bringup, outsider):
    node = outsider.node
    publisher = node.create_publisher(TwistStamped, "mobile_base/reference", 10)
    places = []

    def send():
        message = TwistStamped()
        message.header.stamp = node.get_clock().now().to_msg()
        message.twist.linear.x, message.twist.linear.y = 0.3, 0.2
        publisher.publish(message)

    node.create_subscription(Odometry, "mobile_base/odometry", places.append, 100)
    with bringup("--robot", "mecanum"):
        node.create_timer(0.05, send)
        state = outsider.wait_for_joints(lambda q: q["front_right"] > 2.0)
    assert list(state.name) == ["front_left", "front_right", "rear_right", "rear_left"]
    last = places[-1].pose.pose.position
    # The way goes straight along the command.
    assert last.x > 0.0 and last.y == pytest.approx(last.x * 2.0 / 3.0, abs=1e-9)


def test_a_base_shows_itself_as_rviz_would_see_it(bringup, outsider):
    """Description, joints and frames fit, while wheels roll and steer."""
    node, news = outsider.node, threading.Condition()
    descriptions, states, frames = [], {}, {}

    def keep(take):
        def heard(message):
            with news:
                take(message)
                news.notify_all()

        return heard

    def put(message):
        for entry in message.transforms:
            frames.setdefault(entry.child_frame_id, {})[stamp(entry)] = entry

    def stamp(message):
        return message.header.stamp.sec, message.header.stamp.nanosec

    def command():
        message = TwistStamped()
        message.header.stamp = node.get_clock().now().to_msg()
        message.twist.linear.x, message.twist.angular.z = 0.3, 0.5
        publisher.publish(message)

    publisher = node.create_publisher(TwistStamped, "left/mobile_base/cmd_vel", 10)
    for kind, topic, qos, take in (
        (String, "left/robot_description", LATCHED, lambda m: descriptions.append(m.data)),
        (JointState, "left/joint_states", 100, lambda m: states.update({stamp(m): m})),
        (TFMessage, "/tf", 100, put),
    ):
        node.create_subscription(kind, topic, keep(take), qos)

    def instants():
        """When all wheels have rolled, and all their frames are known."""
        wheels = [of for frame, of in frames.items() if frame != "left/base_link"]
        known = set(states).intersection(*wheels) if len(wheels) == 8 else ()
        return [one for one in known if min(np.abs(states[one].position[:4])) > 1.0]

    with bringup("--robot", "swerve", "--namespace", "left"):
        node.create_timer(0.05, command)
        with news:
            assert news.wait_for(lambda: descriptions and instants(), PATIENCE), sorted(frames)
            when = instants()[0]
            state, (urdf,) = states[when], descriptions
            at = {frame: of[when] for frame, of in frames.items() if frame != "left/base_link"}
            placed = [*frames["left/base_link"].values()][-1]
    assert placed.header.frame_id == "left/odom"
    model = pinocchio.buildModelFromXML(urdf)
    assert {*model.names} - {"universe"} == {*state.name}
    data, q = model.createData(), pinocchio.neutral(model)
    for name, position in zip(state.name, state.position, strict=True):
        joint = model.joints[model.getJointId(name)]
        # A continuous joint is a point on a circle.
        q[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
    pinocchio.framesForwardKinematics(model, data, q)
    for frame, entry in at.items():
        parent, child = (name.removeprefix("left/") for name in (entry.header.frame_id, frame))
        in_parent = data.oMf[model.getFrameId(parent)].actInv(data.oMf[model.getFrameId(child)])
        place, turn = entry.transform.translation, entry.transform.rotation
        found = np.eye(4)
        found[:3, 3] = place.x, place.y, place.z
        found[:3, :3] = matrix_from_quaternion([turn.x, turn.y, turn.z, turn.w])
        np.testing.assert_allclose(found, in_parent.homogeneous, atol=1e-12)


def test_demo_of_a_rolling_robot(suite, tmp_path):
    """Two closed paths; arrival is checked by odometry and by the simulated base."""
    options = ["--robot", "mecanum", "--output", str(tmp_path / "out")]
    done = suite.run("robomech", "demo", *options, timeout=500)
    assert done.returncode == 0, done.stderr
    for path in ("square, turning against it", "eight, heading kept"):
        assert f"{path}: back after" in done.stdout
    assert "100 %  x " in done.stdout and " m, heading " in done.stdout
    assert "everything worked" in done.stdout
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == ["mecanum.html", "mecanum.png"]
    refused = suite.run("robomech", "demo", *options, "--payload", "1", "--dynamic")
    assert refused.returncode == 2
    assert "--dynamic does not apply to 'mecanum', a rolling robot" in refused.stderr
