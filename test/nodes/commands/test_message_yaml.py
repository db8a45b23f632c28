"""Requests and answers as YAML."""

import pytest
import yaml
from geometry_msgs.msg import Point
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_interfaces.srv import PlanJoint, SolveFK, SolveIK, SolveIKBatch
from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.nodes.commands.message_yaml import (
    fill_message,
    interface_class,
    parse_yaml,
    to_yaml,
)


def filled(kind, text):
    message = kind()
    fill_message(message, parse_yaml(text))
    return message


def test_nested_fields_lists_and_constants():
    request = filled(
        SolveIK.Request,
        "{target: {header: {frame_id: base}, pose: {position: {x: 0.4}, orientation: {w: 1}}},"
        " seed: {name: [a, b], position: [1, 2.5]}, mode: NEAREST, max_solutions: 3,"
        " task_mask: [true, true, true, false, false, false], timeout: {sec: 1}}",
    )
    assert request.target.header.frame_id == "base"
    assert request.target.pose.position.x == 0.4
    assert request.target.pose.orientation.w == 1.0
    assert list(request.seed.name) == ["a", "b"]
    assert list(request.seed.position) == [1.0, 2.5]
    assert (request.mode, request.max_solutions) == (SolveIK.Request.NEAREST, 3)
    assert list(request.task_mask) == [True, True, True, False, False, False]
    assert request.timeout.sec == 1


def test_list_of_messages():
    request = filled(SolveFK.Request, "{states: [{position: [1]}, {position: [2]}], links: [x]}")
    assert [list(state.position) for state in request.states] == [[1.0], [2.0]]
    via = filled(PlanJoint.Request, "via: [{positions: [1, 2], time_from_start: {sec: 3}}]").via
    assert list(via[0].positions) == [1.0, 2.0]
    assert via[0].time_from_start.sec == 3


@pytest.mark.parametrize("text", ["", "{}", "  ", "null"])
def test_empty_request(text):
    assert filled(SolveIK.Request, text) == SolveIK.Request()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{targt: {}}", "SolveIK_Request has no field 'targt' (did you mean 'target'?); it has: "),
        ("{target: {pose: {positon: {x: 1}}}}", "(at target.pose) has no field 'positon'"),
        ("{seed: {position: [1, a]}}", "seed.position[1] is 'a', expected a value of type double"),
        ("{seed: {position: 1}}", "seed.position is 1, expected a list of double"),
        ("{target: 3}", "target is 3, expected a mapping with fields of geometry_msgs/PoseStamped"),
        ("{mode: 300}", "mode is 300, expected a value of type uint8"),
        ("{mode: FARTHEST}", "mode is 'FARTHEST'"),
        ("{ignore_limits: 1}", "ignore_limits is 1, expected a value of type boolean"),
        ("{position_tolerance: true}", "position_tolerance is True"),
        ("{task_mask: [true]}", "task_mask is [True], expected a list of 6 boolean"),
        ("{max_solutions: -1}", "max_solutions is -1"),
        ("[1, 2]", "expected a YAML mapping"),
        ("{a: b: c}", "expected YAML ("),
        ("{mode: 1, mode: 0}", "the key 'mode' is given twice"),
        ("[" * 10000, "expected YAML ("),
    ],
)
def test_what_does_not_fit_is_named(text, words):
    with pytest.raises(RobomechError) as caught:
        filled(SolveIK.Request, text)
    assert words in str(caught.value)


def test_merge_keys_that_double_a_request_with_every_line_are_refused():
    text = "m0: &m0 {x: 1}\n"
    text += "".join(f"m{k}: &m{k} {{<<: [*m{k - 1}, *m{k - 1}]}}\n" for k in range(1, 40))
    with pytest.raises(BadValueError, match=r"aliases \(\*name\) are not allowed"):
        parse_yaml(text)


def test_bad_element_of_a_list_is_named():
    with pytest.raises(RobomechError, match=r"states\[1\]"):
        filled(SolveFK.Request, "{states: [{}, {positio: [1]}]}")
    with pytest.raises(RobomechError, match=r"states\[0\] is 5"):
        filled(SolveFK.Request, "{states: [5]}")


def test_answers_read_well_and_parse_back():
    response = SolveIK.Response(joint_names=["a", "b"], family="decoupled", error_msg="none: ü")
    points = filled(PlanJoint.Request, "via: [{positions: [0.5, 1e-12]}]").via
    response.solutions = points
    response.seed_distances = [0.25]
    text = to_yaml(response)
    assert "joint_names: [a, b]\n" in text
    assert "- positions: [0.5, 1.0e-12]\n" in text
    assert "velocities" not in text
    values = yaml.safe_load(text)
    assert values["solutions"][0]["positions"] == [0.5, 1e-12]
    assert values["error_msg"] == "none: ü"
    assert "velocities: []" in to_yaml(response, full=True)


def test_plain_arrays():
    response = SolveIKBatch.Response(counts=[1, 0], codes=[0, 201], solutions=[1.0, 2.0])
    values = yaml.safe_load(to_yaml(response))
    assert values["counts"] == [1, 0]
    assert values["codes"] == [0, 201]
    assert values["solutions"] == [1.0, 2.0]


def test_types_by_name():
    assert interface_class("std_srvs/srv/SetBool") is SetBool
    for name in ("SetBool", "std_srvs/srv/Nothing", "no_such_msgs/srv/It", "../../x"):
        with pytest.raises(BadValueError, match=name.rsplit("/", maxsplit=1)[-1]):
            interface_class(name)


def test_numbers_are_rounded_to_so_many_significant_digits():
    point = JointTrajectoryPoint(positions=[1.23456789e-7, 1234567.8, -0.5])
    point.time_from_start.nanosec = 123456789
    for digits, numbers in (
        (4, [1.235e-07, 1235000.0, -0.5]),
        (17, [1.23456789e-7, 1234567.8, -0.5]),
    ):
        values = yaml.safe_load(to_yaml(point, digits=digits))
        assert [float(number) for number in values["positions"]] == numbers
        assert values["time_from_start"]["nanosec"] == 123456789


@pytest.mark.parametrize("digits", ["\uff11", "1_0", "one"])
def test_digits_of_other_scripts_are_no_numbers(digits):
    with pytest.raises(BadValueError):
        fill_message(Point(), {"x": digits})
