"""Wrong input to a mobile base: each is rejected, or ignored as documented."""

import math
import re

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from twist_driver import Driver

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.nodes.common.parameters import ParameterError, table_rows
from robomech_ros.nodes.mobile_base.drives import INTERFACES
from robomech_ros.nodes.mobile_base.node import MobileBaseNode
from robomech_ros.nodes.mobile_base.settings import FORMER_NAMES, MobileBaseSettings
from robomech_ros.rolling import list_rolling, rolling_robot

ODOMETRY = "mobile_base/odom"
# On four fixed wheels a base cannot turn; three in a row do not determine its twist.
SKID = ("diff", "fixed", ((0.2, 0.2), (0.2, -0.2), (-0.2, 0.2), (-0.2, -0.2)))
ROW = ("omni", "omni", ((0.1, 0.0), (0.2, 0.0), (0.3, 0.0)))


def document(drive, kind, places):
    wheels = [
        f"- {{name: wheel_{number}, kind: {kind}, position: {[*place]}, radius: 0.1}}"
        for number, place in enumerate(places)
    ]
    head = ["kind: rolling", "name: wrong", "source: this test", f"drive: {drive}", "wheels:"]
    return "\n".join([*head, *wheels, ""])


@pytest.mark.parametrize(
    ("wheels", "text"), [(SKID, "one common axle"), (ROW, "free now are twists")]
)
def test_wheels_that_contradict_each_other_or_do_not_suffice_make_no_node(graph, wheels, text):
    with pytest.raises(RobotDescriptionError, match=f"wheel_0, wheel_1, .*{text}"):
        graph.start(MobileBaseNode, robot_description=document(*wheels))


@pytest.mark.parametrize("value", [-0.1, math.inf, 3600.1])
@pytest.mark.parametrize("name", ["cmd_vel_timeout", "reference_timeout"])
def test_time_outs_that_are_none_are_refused(graph, name, value):
    with pytest.raises(ParameterError, match=f"'{name}' is {value}; .* from 0 to 3600 s"):
        graph.start(MobileBaseNode, robot_description="mecanum", **{name: value})


@pytest.mark.parametrize("robot", list_rolling())
def test_a_number_that_is_none_spoils_a_command_whichever_it_is(graph, robot):
    """Also one of a component that the drive does not have."""
    node = graph.start(MobileBaseNode, robot_description=robot)
    interface = INTERFACES[rolling_robot(robot).drive]
    odometry = interface.odometry.replace("~", "mobile_base")
    publisher = graph.client.create_publisher(
        TwistStamped, interface.command.replace("~", "mobile_base"), 10
    )
    fields = [(part, axis) for part in ("linear", "angular") for axis in "xyz"]
    for part, axis in fields:
        spoilt = TwistStamped()
        spoilt.twist.linear.x = 0.3
        setattr(getattr(spoilt.twist, part), axis, math.nan)

        def refused(_, spoilt=spoilt, name=f"{part}.{axis}"):
            publisher.publish(spoilt)
            return f"ignored: {name} is nan" in node._intake.refusal

        seen = graph.receive(Odometry, odometry, 10, refused)
        assert seen.twist.twist.linear.x == 0.0 and seen.pose.pose.position.x == 0.0


def test_names_of_humble_are_answered_with_those_of_today(graph, capfd):
    given = {
        "rear_wheels_names": ["right", "left"],
        "front_wheels_names": ["front_right", "front_left"],
        "rear_wheel_track": 0.6,
        "rear_wheels_radius": 0.1,
        "wheelbase": 1.0,
    }
    with pytest.raises(ParameterError, match="'traction_joints_names' is "):
        graph.start(MobileBaseNode, drive="ackermann", **given)
    said = capfd.readouterr().err
    for old, new in (
        ("rear_wheels_names", "traction_joints_names"),
        ("front_wheels_names", "steering_joints_names"),
        ("rear_wheel_track", "traction_track_width"),
        ("rear_wheels_radius", "traction_wheels_radius"),
    ):
        assert f"parameter '{old}' is ignored: its name here is '{new}'" in said
    known = {row.name for row in table_rows(MobileBaseSettings)}
    assert not known & set(FORMER_NAMES)
    assert all(set(re.findall(r"'(\w+)'", text)) <= known for text in FORMER_NAMES.values())


@pytest.mark.parametrize("robot", ["differential", "tricycle", "ackermann"])
def test_what_the_drive_cannot_give_is_left_out_and_nothing_is_refused(graph, robot):
    node = graph.start(MobileBaseNode, robot_description=robot)
    interface = INTERFACES[rolling_robot(robot).drive]
    Driver(graph, interface.command.replace("~", "mobile_base")).command(0.3, 0.5)
    odometry = interface.odometry.replace("~", "mobile_base")
    seen = graph.receive(Odometry, odometry, 10, lambda m: abs(m.twist.twist.linear.x - 0.3) < 1e-6)
    assert seen.twist.twist.linear.y == 0.0 and abs(seen.pose.pose.position.y) < 1e-12
    assert node._intake.refused == 0


def test_a_command_beyond_limits_moves_the_base_at_its_limits_and_is_told(graph):
    graph.start(MobileBaseNode, robot_description="differential")
    Driver(graph, "mobile_base/cmd_vel").command(50.0)
    # Its wheels are at their limits before the base is at its own.
    base = rolling_robot("differential").base
    fastest = base.wheels[0].max_rate * base.wheels[0].radius
    graph.receive(Odometry, ODOMETRY, 10, lambda m: abs(m.twist.twist.linear.x - fastest) < 1e-6)
    told = graph.receive(
        DiagnosticArray, "/diagnostics", 10, lambda m: "limited by" in m.status[0].message
    )
    assert told.status[0].level == b"\x01"
    last = graph.receive(Odometry, ODOMETRY, 10, lambda m: True)
    assert last.twist.twist.linear.x <= fastest * (1.0 + 1e-9)
