"""`robomech export-urdf`."""

import pytest

from robomech_ros.cli.main import main
from robomech_ros.hands import load_hand
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import load_description, load_robot, urdf_from_description
from robomech_ros.robots.robot_kinds import KINDS, documents_of
from robomech_ros.rolling import WheelJoints, load_rolling
from robomech_ros.walking import load_legged


def test_a_document_goes_to_a_file_or_to_standard_output(tmp_path, capsys):
    path = tmp_path / "puma.urdf"
    assert main(["export-urdf", "puma560", "--output", str(path)]) == 0
    assert capsys.readouterr().out == f"wrote {path}\n"
    assert load_robot(path, tip="tool0").joint_names == load_robot("puma560").joint_names
    assert main(["export-urdf", "puma560"]) == 0
    assert capsys.readouterr().out == path.read_text(encoding="utf-8")
    assert path.read_text(encoding="utf-8") == urdf_from_description(load_description("puma560"))


@pytest.mark.parametrize("name", documents_of("parallel"))
def test_the_tree_of_a_parallel_robot_is_what_nodes_publish_and_keeps_its_loops(name, capsys):
    assert main(["export-urdf", name]) == 0
    text, said = capsys.readouterr()
    robot = load_tree_description(name)
    assert text == urdf_from_description(robot.description)
    again = load_tree_description(text)
    assert again.mechanism.actuated == robot.mechanism.actuated
    assert text.count("<!-- Loops are cut") == 1 and text.endswith("</robot>\n")
    ends = [limb.chain.tip for limb in robot.mechanism.limbs[1:]]
    assert f"the loops are cut at {', '.join(ends)}, which belong at 'platform'" in said
    assert said.count("\n") == 1


OTHERS = [(kind, name) for kind in KINDS if kind != "parallel" for name in documents_of(kind)]


@pytest.mark.parametrize(("kind", "name"), OTHERS)
def test_robots_of_other_kinds_have_all_their_joints(kind, name, capsys):
    assert main(["export-urdf", name]) == 0
    text, said = capsys.readouterr()
    moving = {joint.name for joint in load_description(text).joints if joint.moves}
    if kind == "rolling":
        assert moving == set(WheelJoints.of(load_rolling(name)).names)
    else:
        robot = load_hand(name) if kind == "hand" else load_legged(name)
        limbs = robot.fingers if kind == "hand" else robot.legs
        assert moving == {joint for limb in limbs for joint in limb.joint_names}
    assert said == ""


def test_a_misspelt_robot_may_be_of_any_kind(capsys):
    assert main(["export-urdf", "three_finger"]) == 2
    assert "did you mean 'three_fingered'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (["no_robot"], 2, "unknown robot 'no_robot'"),
        (["ur5e", "--output", "/nowhere/arm.urdf"], 1, "/nowhere/arm.urdf: No such file"),
    ],
)
def test_what_cannot_be_written(arguments, code, text, capsys):
    assert main(["export-urdf", *arguments]) == code
    assert text in capsys.readouterr().err
