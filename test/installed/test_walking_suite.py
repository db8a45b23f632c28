"""A walking machine that is brought up, walked and watched across processes."""

import threading

import pytest
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry

from robomech_interfaces.msg import FootContacts
from robomech_ros.walking import load_legged

PATIENCE = 120.0


def test_a_hexapod_is_brought_up_walks_and_stops_with_all_feet_down(bringup, outsider):
    node, news, walks = outsider.node, threading.Condition(), [True]
    publisher = node.create_publisher(TwistStamped, "cmd_vel", 10)
    heard = {Odometry: [], FootContacts: []}

    def send():
        if walks[0]:
            message = TwistStamped()
            message.twist.linear.x = 0.03
            publisher.publish(message)

    def take(message):
        with news:
            heard[type(message)].append(message)
            news.notify_all()

    node.create_subscription(Odometry, "odom", take, 100)
    node.create_subscription(FootContacts, "foot_contacts", take, 100)
    robot = load_legged("phantomx")
    with bringup("--robot", "phantomx"):
        node.create_timer(0.05, send)
        state = outsider.wait_for_joints(lambda q: abs(q["LF_coxa"]) > 0.02)
        assert tuple(state.name) == robot.joint_names
        with news:
            places = heard[Odometry]
            assert news.wait_for(
                lambda: places and places[-1].pose.pose.position.x > 0.03, PATIENCE
            )
            walks[0] = False
            known = len(places)
            still = places[-1].twist.twist
            assert news.wait_for(
                lambda: (
                    len(places) > known
                    and places[-1].twist.twist.linear.x == 0.0
                    and all(heard[FootContacts][-1].contacts)
                ),
                PATIENCE,
            )
    assert still.linear.x > 0.0
    contacts = heard[FootContacts]
    assert tuple(contacts[-1].names) == robot.leg_names
    # Tripod: three feet or more stand at any time.
    assert min(sum(one.contacts) for one in contacts) == 3
    assert abs(places[-1].pose.pose.position.y) < 1e-9


@pytest.mark.parametrize("robot", ["hexapod_walker", pytest.param("go1", marks=pytest.mark.long)])
def test_demo_of_a_walking_machine(suite, tmp_path, robot):
    """An eight is walked; odometry and every foot that stands are looked at."""
    output = tmp_path / "out"
    done = suite.run("robomech", "demo", "--robot", robot, "--output", str(output), timeout=280)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "by odometry it is" in done.stdout and "by the joints, standing feet" in done.stdout
    assert "everything worked" in done.stdout
    name = load_legged(robot).name
    assert sorted(path.name for path in output.iterdir()) == [f"{name}.html", f"{name}.png"]
    moved = (output / f"{name}.html").read_text(encoding="utf-8")
    assert f"{name}: an eight" in moved and len(moved) > 500_000
    refused = suite.run("robomech", "demo", "--robot", robot, "--payload", "2", "--dynamic")
    assert refused.returncode == 2 and "--dynamic does not apply" in refused.stderr
