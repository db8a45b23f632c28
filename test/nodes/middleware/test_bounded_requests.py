"""Requests with more entries than can be read in a moment, corrupt ones above all."""

import array
import ctypes
import os
import struct
import subprocess
import time

import pytest
from moveit_msgs.msg import BoundingVolume, PositionConstraint
from moveit_msgs.srv import GetCartesianPath, GetPositionFK
from raw_writer import RawWriter
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.serialization import serialize_message
from rclpy.type_support import check_for_type_support
from sensor_msgs.msg import JointState
from shape_msgs.msg import SolidPrimitive
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_interfaces.srv import PlanJoint, SolveFK
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.middleware.bounded_requests import MOST_OBJECTS, address_in, count_objects
from robomech_ros.nodes.process.process_group import node_command
from robomech_ros.outcomes import Code


def cartesian_request(primitives):
    region = BoundingVolume(primitives=primitives)
    request = GetCartesianPath.Request()
    request.path_constraints.position_constraints = [PositionConstraint(constraint_region=region)]
    return serialize_message(request)


def parameter_request(parameters):
    return serialize_message(SetParameters.Request(parameters=parameters))


def numbers_of(entry):
    """Give a parameter with a list of numbers."""
    return Parameter(value=ParameterValue(integer_array_value=entry))


def count_at(empty, one):
    """Find the length of a list by requests that differ in it."""
    return next(
        k
        for k in range(4, len(empty), 4)
        if empty[k : k + 4] == bytes(4) and one[k : k + 4] == b"\1\0\0\0"
    )


def announcing(count, none, one, inner):
    """Announce so many entries, the first of which announces more numbers than memory holds.

    The middleware makes room for the bytes of the numbers, fails to make the list, and reads all
    further entries from that room.  The three requests have no entry, one, and one with a number.
    """
    data = bytearray(one)
    data[count_at(one, inner) :] = struct.pack("<I", 450_000_000) + bytes(20)
    at = count_at(none, one)
    data[at : at + 4] = struct.pack("<I", count)
    return bytes(data)


CASES = {
    "compute_cartesian_path": (
        GetCartesianPath,
        cartesian_request([]),
        cartesian_request([SolidPrimitive()]),
        cartesian_request([SolidPrimitive(dimensions=[0.0])]),
    ),
    "set_parameters": (
        SetParameters,
        parameter_request([]),
        parameter_request([numbers_of([])]),
        parameter_request([numbers_of([0])]),
    ),
}


@pytest.fixture
def planner(domain_id):
    """The node trajectory_planner as a process of its own."""
    command = node_command("trajectory_planner", ["-p", "robot_description:=puma560"])
    process = subprocess.Popen(command, env=os.environ | {"ROS_DOMAIN_ID": str(domain_id)})
    yield process
    process.terminate()
    assert process.wait(60.0) == 0


@pytest.mark.parametrize("service", CASES)
def test_a_list_that_is_announced_only_keeps_nobody_waiting(graph, planner, service):
    """Four million entries took 20 s of processor time; after 20 million the service was dead."""
    kind, *requests = CASES[service]
    name = f"/trajectory_planner/{service}"
    graph.call(Trigger, "trajectory_planner/ready", Trigger.Request())
    graph.call(kind, name, kind.Request())
    writer = RawWriter(graph.client, kind, name)
    deadline = time.monotonic() + 60.0
    while not writer.readers() and time.monotonic() < deadline:
        time.sleep(0.05)
    before = processor_time(planner)
    assert writer.write(announcing(4_000_000, *requests))
    assert graph.call(Trigger, "trajectory_planner/ready", Trigger.Request()).success
    graph.call(kind, name, kind.Request())
    writer.close()
    assert processor_time(planner) < before + 5.0


def test_a_request_that_is_too_large_is_answered(graph):
    graph.start(KinematicsNode, robot_description="puma560")
    request = SolveFK.Request(links=["base_link"] * (MOST_OBJECTS + 1))
    answer = graph.call(SolveFK, "kinematics/solve_fk", request)
    assert answer.error_code == Code.WRONG_SIZE
    assert str(MOST_OBJECTS) in answer.error_msg
    answer = graph.call(SolveFK, "kinematics/solve_fk", SolveFK.Request(links=["base_link"]))
    assert answer.error_code == 0, answer.error_msg


def objects_of(value):
    """Count the objects of a message made by rclpy: messages, texts, lists and their entries."""
    if hasattr(value, "get_fields_and_field_types"):
        fields = value.get_fields_and_field_types()
        return 1 + sum(objects_of(getattr(value, name)) for name in fields)
    if isinstance(value, array.array):
        return 1 + len(value) / 20
    return 1 + sum(map(objects_of, value)) if isinstance(value, list) else isinstance(value, str)


def test_the_count_is_that_of_the_objects_which_rclpy_makes():
    state = JointState(name=["a", "b"], position=[1.0] * 40, velocity=[2.0])
    point = JointTrajectoryPoint(positions=[1.0] * 6)
    requests = [
        SolveFK.Request(links=["one", "two"], joint_states=[state] * 3),
        PlanJoint.Request(start=state, via=[point] * 2),
        GetPositionFK.Request(fk_link_names=["tool0"]),
    ]
    for request in requests:
        check_for_type_support(type(request))
        meta, kind = type(type(request)), type(request)
        create = ctypes.PYFUNCTYPE(ctypes.c_void_p)(address_in(meta._CREATE_ROS_MESSAGE))
        fill = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, ctypes.c_void_p)
        message = create()
        assert fill(address_in(meta._CONVERT_FROM_PY))(request, message)
        assert count_objects(message, kind) == pytest.approx(objects_of(request))
        ctypes.PYFUNCTYPE(None, ctypes.c_void_p)(address_in(meta._DESTROY_ROS_MESSAGE))(message)


def processor_time(process):
    """Give the processor time that a process has taken, s."""
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as stream:
        fields = stream.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
