"""The servo node with the simulated robot: motions, statuses, refusals, pauses."""

import time
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from servo_operator import START, Operator
from tf2_msgs.msg import TFMessage

from robomech_interfaces.msg import ServoStatus
from robomech_ros.kinetostatics import jacobian
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.servo.command_reader import CommandReader
from robomech_ros.nodes.servo.node import ServoNode
from robomech_ros.nodes.servo.settings import SPEED_UNITS
from robomech_ros.robots import load_robot


def test_drives_the_tip_straight_and_stops_when_nobody_commands(operator):
    hand = operator()
    first = hand.tip()
    hand.repeat(hand.twist(linear=(0, 0.2, 0)), lambda: hand.tip()[1, 3] > first[1, 3] + 0.05)
    hand.wait_for(lambda: hand.has_code(ServoStatus.STALE_COMMAND, "stale"))
    hand.until_still()
    moved = hand.tip()[:3, 3] - first[:3, 3]
    assert abs(moved[0]) < 0.01 * moved[1] and abs(moved[2]) < 0.01 * moved[1]
    np.testing.assert_allclose(hand.tip()[:3, :3], first[:3, :3], atol=0.01)
    for _, message in hand.streamed:
        assert not any(message.points[-1].velocities)
        assert len(message.points) > 1 or message.points[0].time_from_start.nanosec > 0


@pytest.mark.parametrize(("ahead", "left"), [(-0.1, 0.15), (0.0, 0.25), (0.1, 0.25)])
def test_a_command_counts_from_its_stamp(ahead, left):
    clock = SimpleNamespace(now=lambda: 100.0, until=lambda stamp, now: stamp.sec - now + ahead)
    settings = SimpleNamespace(command_timeout=0.25, command_in_type=SPEED_UNITS, joint_scale=1.0)
    model = SimpleNamespace(chain=load_robot("puma560"))
    reader = CommandReader(model, None, None, clock, lambda: settings, lambda: 0.0)
    message = JointState(name=["elbow"], velocity=[0.1])
    message.header.stamp.sec = 100
    assert reader.joint_state(message).until == pytest.approx(100.0 + left)


def test_a_stream_continues_itself_and_ends_at_rest(simulated_time, operator):
    """Every message tells what the one before it told for the same time, up to its first point.

    By simulated time, which stands while the machine is busy: nothing comes too late.
    """
    hand = operator(arm={"use_sim_time": True}, use_sim_time=True)
    simulated_time.wait_for(hand.arm.states)
    names = ["waist", "elbow"]
    hand.repeat(hand.speeds(names, [0.3, -0.2]), lambda: len(hand.streamed) > 30)
    hand.until_still()

    def arrived():
        end = hand.streamed[-1][1].points[-1].positions
        return not hand.arm.velocity.any() and np.allclose(hand.arm.position, end, atol=1e-6)

    # While the time stands nothing comes, as at the end.
    hand.wait_for(arrived)
    told = [message for _, message in hand.streamed]
    for message in told:
        assert message.joint_names == hand.arm.names
        assert not any(message.points[-1].velocities)
        assert all(len(p.positions) == len(p.velocities) == 6 for p in message.points)
    same = [(a, b) for a, b in pairwise(told) if len(a.points) > 1]
    continued = [
        np.allclose(a.points[1].positions, b.points[0].positions, atol=1e-9) for a, b in same
    ]
    # A node that is held up for longer than a period goes on where its plan to stop has led.
    assert np.mean(continued) > 0.1


def test_what_is_free_of_the_pose_changes_at_run_time(operator):
    hand = operator()
    first = hand.tip()
    hand.repeat(hand.twist(linear=(0, 0.2, 0)), lambda: hand.tip()[1, 3] > first[1, 3] + 0.04)
    hand.until_still()
    np.testing.assert_allclose(hand.tip()[:3, :3], first[:3, :3], atol=0.01)

    def free(*names):
        value = ParameterValue(type=ParameterType.PARAMETER_STRING_ARRAY, string_array_value=names)
        change = Parameter(name="free_directions", value=value)
        request = SetParameters.Request(parameters=[change])
        return hand.graph.call(SetParameters, "servo/set_parameters", request).results[0]

    for wrong in (["rw"], ["x", "y", "z", "rx", "ry", "rz"]):
        refused = free(*wrong)
        assert not refused.successful
        assert "at most five of" in refused.reason
    assert free("rx", "ry", "rz").successful
    begun = hand.tip()
    hand.repeat(hand.twist(linear=(0, 0.2, 0)), lambda: hand.tip()[1, 3] > begun[1, 3] + 0.06)
    hand.until_still()
    moved = hand.tip()[:3, 3] - begun[:3, 3]
    assert abs(moved[0]) < 0.01 * moved[1] and abs(moved[2]) < 0.01 * moved[1]
    assert np.abs(hand.tip()[:3, :3] - begun[:3, :3]).max() > 0.02


def test_joints_move_at_the_velocities_commanded_and_the_others_stand(operator):
    hand = operator()
    first = hand.arm.position
    send = hand.speeds(["elbow"], [-0.4])
    hand.repeat(send, lambda: hand.arm.position[2] < first[2] - 0.1)
    hand.until_still()
    moved = hand.arm.position - first
    assert moved[2] < -0.1 and np.abs(np.delete(moved, 2)).max() < 1e-9


def test_the_frame_of_a_twist_is_that_of_its_axes(operator):
    hand = operator()
    before = hand.tip()
    tip = hand.arm.chain.tip
    hand.repeat(
        hand.twist(linear=(0, 0, 0.2), frame=tip),
        lambda: np.linalg.norm(hand.tip()[:3, 3] - before[:3, 3]) > 0.04,
    )
    way = before[:3, :3].T @ (hand.tip()[:3, 3] - before[:3, 3])
    assert way[2] > 0.03 and np.abs(way[:2]).max() < 0.05 * way[2]


def test_a_twist_in_the_world_above_the_base(operator):
    hand = operator()
    client = hand.graph.client
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = client.create_publisher(TFMessage, "/tf_static", latched)
    # The base is turned by a quarter about z: y of the world is x of the base.
    message = TransformStamped(child_frame_id=hand.arm.chain.base)
    message.header.frame_id = "world"
    message.transform.rotation.z = message.transform.rotation.w = np.sqrt(0.5)
    publisher.publish(TFMessage(transforms=[message]))
    before = hand.tip()
    hand.repeat(
        hand.twist(linear=(0, -0.2, 0), frame="world"),
        lambda: np.linalg.norm(hand.tip()[:3, 3] - before[:3, 3]) > 0.04,
    )
    way = hand.tip()[:3, 3] - before[:3, 3]
    assert way[0] < -0.03 and np.abs(way[1:]).max() < 0.05 * -way[0]


def test_unitless_commands_are_parts_of_the_scales(operator):
    hand = operator(command_in_type="unitless", joint_scale=0.2)
    hand.repeat(hand.speeds(["waist"], [0.5]), lambda: len(hand.streamed) > 40)
    fastest = max(abs(point.velocities[0]) for _, m in hand.streamed for point in m.points)
    assert 0.05 < fastest <= 0.1 + 1e-9
    text = r"linear.x is 1.5, expected from -1 to 1, as command_in_type is unitless"
    hand.repeat(hand.twist(linear=(1.5, 0, 0)), lambda: hand.has_code(ServoStatus.INVALID, text))


def test_unitless_twists_are_parts_of_the_scale_of_their_kind(operator):
    hand = operator(command_in_type="unitless", linear_scale=0.1, rotational_scale=0.4)
    hand.repeat(hand.twist(linear=(0, 0.5, 0)), lambda: len(hand.streamed) > 40)
    points = [point for _, message in hand.streamed for point in message.points]
    rows = [jacobian(hand.arm.chain, p.positions)[3:] @ p.velocities for p in points]
    fastest = np.linalg.norm(rows, axis=1).max()
    assert 0.025 < fastest < 0.051


def ago(seconds):
    whole, rest = divmod(time.time_ns() - round(1e9 * seconds), 10**9)
    return Time(sec=whole, nanosec=rest)


BAD = {
    "frame": (
        lambda hand: hand.twist((0.1, 0, 0), frame="no_such"),
        "delta_twist_cmds' refused: frame 'no_such': the robot has no such link, and tf has no",
    ),
    "nan": (lambda hand: hand.twist((0, np.nan, 0)), "twist.linear.y is nan, expected finite"),
    "infinite": (lambda hand: hand.twist(angular=(0, 0, -np.inf)), "twist.angular.z is -inf"),
    "huge": (
        lambda hand: hand.twist((1e300, 0, 0)),
        "twist.linear.x is 1e+300, expected at most 1000 m/s",
    ),
    "joint": (
        lambda hand: hand.speeds(["elbw"], [0.1]),
        "unknown joint 'elbw' (did you mean 'elbow'?)",
    ),
    "size": (
        lambda hand: hand.speeds(["elbow", "waist"], [0.1]),
        "velocity has size 1, expected 2, one for every name",
    ),
    "none": (lambda hand: hand.speeds([], []), "joint names has size 0, expected one at least"),
    "twice": (
        lambda hand: hand.speeds(["elbow", "elbow"], [0.1, 0.1]),
        "joint names has size 2, expected each once; 'elbow' is repeated",
    ),
    "late": (
        lambda hand: lambda: hand.twist((0.1, 0, 0), stamp=ago(0.3))(),
        "s ago', expected a command from the last 0.1 s, the parameter command_timeout",
    ),
    "joint nan": (
        lambda hand: hand.speeds(["elbow"], [np.nan]),
        "velocity of joint 'elbow' is nan",
    ),
    "old": (
        lambda hand: hand.twist((0.1, 0, 0), stamp=Time(sec=1)),
        "s ago', expected a command from the last 0.1 s, the parameter command_timeout",
    ),
    "future": (
        lambda hand: hand.twist((0.1, 0, 0), stamp=Time(sec=2**31 - 1)),
        "s in the future', expected a command from the last 0.1 s",
    ),
}


def test_what_cannot_be_followed_is_refused_by_name_and_moves_nothing(operator):
    hand = operator()
    for name, (command, text) in BAD.items():
        send = command(hand)
        hand.repeat(send, lambda text=text: hand.has_code(ServoStatus.INVALID, text))
        assert not hand.streamed, name
    assert np.abs(hand.arm.position - START).max() < 1e-9


def test_a_refused_command_leaves_the_last_valid_one_until_it_is_stale(operator):
    hand = operator()
    good, bad = hand.twist((0, 0.1, 0)), hand.twist((0, np.nan, 0))
    hand.repeat(good, lambda: len(hand.streamed) > 10)

    def both():
        good()
        bad()

    hand.repeat(both, lambda: hand.has_code(ServoStatus.INVALID, "twist.linear.y is nan"))
    moving = len(hand.streamed)
    hand.repeat(both, lambda: len(hand.streamed) > moving + 10)
    assert any(hand.streamed[-1][1].points[0].velocities)
    hand.repeat(bad, lambda: not hand.arm.velocity.any())
    hand.until_still()


def test_one_kind_of_command_at_a_time(operator):
    hand = operator()
    twist, speeds = hand.twist((0, 0.1, 0)), hand.speeds(["elbow"], [0.1])
    hand.repeat(twist, lambda: len(hand.streamed) > 5)

    def both():
        twist()
        speeds()

    text = "joint_velocity_cmds' refused: commands of another kind are being followed"
    hand.repeat(both, lambda: hand.has_code(ServoStatus.INVALID, text))
    hand.until_still()
    hand.repeat(speeds, lambda: hand.has_code(ServoStatus.NO_WARNING))


def test_pause_brakes_and_what_was_commanded_before_moves_nothing_after(operator):
    hand = operator()
    send = hand.twist((0, 0.2, 0))
    hand.repeat(send, lambda: len(hand.streamed) > 15)
    answer = hand.pause(True)
    assert answer.success and answer.message == "paused: brakes and holds"
    hand.repeat(send, lambda: hand.has_code(ServoStatus.PAUSED, "paused"))
    hand.until_still()
    place, streamed = hand.arm.position, len(hand.streamed)
    deadline = time.monotonic() + 0.3
    send()
    hand.wait_for(lambda: time.monotonic() > deadline)
    assert hand.pause(False).message == "follows commands"
    hand.wait_for(lambda: hand.has_code(ServoStatus.NO_WARNING))
    assert len(hand.streamed) == streamed
    np.testing.assert_array_equal(hand.arm.position, place)
    hand.repeat(send, lambda: np.abs(hand.arm.position - place).max() > 0.01)


def test_ten_thousand_commands_a_second_are_followed_like_few(operator):
    hand = operator()
    send, before = hand.twist((0, 0.1, 0)), hand.tip()
    for _ in range(100):
        for _ in range(50):
            send()
        time.sleep(0.005)
    hand.until_still()
    assert {m.code for _, m in hand.statuses} <= {
        ServoStatus.NO_WARNING,
        ServoStatus.RATE_BOUND,
        ServoStatus.STALE_COMMAND,
    }
    assert hand.tip()[1, 3] > before[1, 3] + 0.01


def test_without_a_state_of_the_joints_nothing_is_published(graph):
    hand = Operator(None, graph)
    hand.repeat(
        hand.twist((0, 0.1, 0)),
        lambda: hand.has_code(ServoStatus.NO_STATE, "no present state of joint(s) waist"),
    )
    assert not hand.streamed
    assert np.isnan(hand.last_status().condition_number)


def test_a_robot_without_velocity_limits_is_left_alone(graph, capfd):
    file = Path(__file__).parents[4] / "config" / "robots" / "planar3r.yaml"
    lines = file.read_text(encoding="utf-8").splitlines()
    robot = "\n".join(line for line in lines if not line.strip().startswith("velocity:"))
    node = graph.start(ServoNode, robot_description=robot, characteristic_length=0.3)
    assert node.get_name() == "servo"
    assert "this robot cannot be driven: no velocity limit for joints" in capfd.readouterr().err


def test_thresholds_that_cross_are_refused(graph):
    with pytest.raises(ParameterError, match="'lower_singularity_threshold' is 90.0; allowed is"):
        graph.start(ServoNode, robot_description="scara", lower_singularity_threshold=90.0)


def test_joint_jog_is_understood_where_control_msgs_is_installed(operator):
    JointJog = pytest.importorskip("control_msgs.msg").JointJog
    hand = operator()
    publisher = hand.graph.client.create_publisher(JointJog, "servo/delta_joint_cmds", 10)
    hand.wait_for(publisher.get_subscription_count)

    def sender(**fields):
        return lambda: publisher.publish(JointJog(**fields))

    for fields, text in (
        ({"duration": -1.0}, "duration is -1.0, expected a time of 0 s (not given) or more"),
        ({"displacements": [0.1]}, "duration is 0.0, expected more than 0 s, for displacements"),
        (
            {"displacements": [0.1], "velocities": [0.1], "duration": 1.0},
            "velocities is [0.1], expected none beside displacements",
        ),
        ({"velocities": [0.1, 0.2]}, "velocities has size 2, expected 1, one for every name"),
        (
            {"displacements": [1e300], "duration": 1e-300},
            "duration is 1e-300, expected a time in which the displacements can be",
        ),
    ):
        send = sender(joint_names=["waist"], **fields)
        hand.repeat(send, lambda text=text: hand.has_code(ServoStatus.INVALID, text))
    start = hand.arm.position[0]
    send = sender(joint_names=["waist"], displacements=[0.1], duration=0.5)
    hand.repeat(send, lambda: hand.arm.position[0] > start + 0.05)
    fastest = max(abs(point.velocities[0]) for _, m in hand.streamed for point in m.points)
    assert fastest <= 0.2 + 1e-9


def test_the_status_comes_also_when_nothing_happens(operator):
    hand = operator()
    hand.wait_for(lambda: hand.has_code(ServoStatus.NO_WARNING))
    # More than come while the node looks for commands after its start.
    said = len(hand.statuses)
    hand.wait_for(lambda: len(hand.statuses) >= said + 4)
    assert not hand.streamed


def test_a_goal_that_is_sent_as_the_stream_ends_is_reached(operator):
    hand = operator()
    send = hand.speeds(["waist", "elbow"], [0.5, -0.3])
    for _ in range(3):
        moved = hand.arm.position[0] + 0.1
        hand.repeat(send, lambda moved=moved: hand.arm.position[0] > moved)
        hand.wait_for(lambda: not hand.arm.velocity.any())
        status, result = hand.arm.execute(hand.arm.trajectory((0.5, [-0.1, 0, 0.05, 0, 0, 0])))
        assert (status, result.error_msg) == (GoalStatus.STATUS_SUCCEEDED, "")


def test_nothing_is_repeated_while_the_robot_brakes(operator):
    hand = operator(halt_messages=2)
    send = hand.speeds(["waist"], [1.5])
    hand.repeat(send, lambda: hand.arm.velocity[0] > 1.0)
    hand.until_still()
    ends = [message.points[-1].positions[0] for _, message in hand.streamed]
    last = [end for end in ends if abs(end - ends[-1]) < 1e-6]
    assert len(last) <= 4
    np.testing.assert_allclose(hand.arm.position[0], ends[-1], atol=1e-6)
