"""Robots of any kind as trees of links, and with their loops where they are parallel."""

import json
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import RobotDescriptionError, UnknownRobotError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.parallel import list_parallel, load_parallel, load_tree_description
from robomech_ros.robots import load_description
from robomech_ros.robots.robot_kinds import documents_of

ELEMENT = '<robot name="cell"><link name="base_link"/>{}</robot>'


@pytest.mark.parametrize("name", list_parallel())
def test_tree_and_loops_come_back_from_the_text_of_the_tree(name):
    robot = load_tree_description(name)
    again = load_tree_description(robot.description.document)
    mechanism = robot.mechanism
    moving = tuple(joint.name for joint in robot.description.joints if joint.moves)
    assert moving == mechanism.joint_names == again.mechanism.joint_names
    assert again.mechanism.actuated == mechanism.actuated
    assert again.mechanism.home() == pytest.approx(mechanism.home(), abs=1e-12)
    home = [robot.description.home[joint] for joint in mechanism.joint_names]
    assert mechanism.loop_errors(home).max() < 1e-10
    assert again.description.home == pytest.approx(robot.description.home, abs=1e-12)


@pytest.mark.parametrize("name", ["hexapod", "delta"])
def test_all_limbs_of_the_tree_end_where_the_platform_is(name):
    robot = load_tree_description(name)
    mechanism, q = robot.mechanism, robot.mechanism.home()
    at = dict(zip(mechanism.joint_names, q, strict=True))
    for link in [limb.chain.tip for limb in mechanism.limbs]:
        chain = robot.description.chain("base_link", link)
        T = forward_kinematics(chain, np.array([at[joint] for joint in chain.joint_names]))
        np.testing.assert_allclose(T, mechanism.pose(q), atol=1e-12)


def test_robots_by_path_and_by_text():
    path = documents_of("parallel")["hexapod"]
    names = load_parallel("hexapod").mechanism.joint_names
    for given in (path, str(path), path.read_text()):
        assert load_tree_description(given).mechanism.joint_names == names


def test_robots_without_loops_are_as_they_were(tmp_path):
    arm = load_tree_description("puma560")
    assert arm.mechanism is None
    assert arm.description.joints[0].name == load_description("puma560").joints[0].name
    with pytest.raises(RobotDescriptionError, match=r"none\.yaml"):
        load_tree_description(tmp_path / "none.yaml")


def test_unknown_names_are_answered_with_those_of_both_kinds():
    with pytest.raises(UnknownRobotError) as caught:
        load_tree_description("hexapodd")
    assert {"hexapod", "puma560"} <= set(caught.value.available)


@pytest.mark.parametrize(
    ("element", "text"),
    [
        ("<parallel_robot/>", "missing attribute 'document'"),
        ('<parallel_robot document="{}"/>', "missing key"),
        ('<parallel_robot document="7"/>', "the top level is int"),
    ],
)
def test_elements_that_are_no_parallel_robot(element, text):
    with pytest.raises(RobotDescriptionError, match=text):
        load_tree_description(ELEMENT.format(element))


def test_element_of_another_tree_is_refused():
    whole = load_tree_description("delta").description.document
    start = whole.index("<parallel_robot")
    element = whole[start : whole.index("/>", start) + 2]
    with pytest.raises(RobotDescriptionError, match="'leg1_base' is not in the tree"):
        load_tree_description(ELEMENT.format(element))


def test_document_of_the_element_is_the_one_of_the_file():
    text = load_tree_description("hexapod").description.document
    start = text.index("document='") + len("document='")
    document = json.loads(text[start : text.index("'/>", start)].replace("&quot;", '"'))
    assert document["kind"] == "parallel"
    assert Path(documents_of("parallel")[document["name"]]).is_file()
