"""A rolling robot that is brought up, driven and watched across processes."""

import pytest
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry


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
