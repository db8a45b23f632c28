"""`robomech groups`, and named postures in `robomech plot`."""

import pytest

from robomech_ros.cli.main import main

SRDF = """<robot name="ur5e">
  <group name="arm"><chain base_link="base_link" tip_link="tool0"/></group>
  <group name="wrist"><joint name="wrist_1_joint"/><joint name="wrist_3_joint"/></group>
  <end_effector name="cup" parent_link="tool0" group="wrist"/>
  <group_state name="up" group="arm">
    <joint name="shoulder_pan_joint" value="0.2"/><joint name="shoulder_lift_joint" value="-1.2"/>
    <joint name="elbow_joint" value="1.1"/><joint name="wrist_1_joint" value="-0.4"/>
    <joint name="wrist_2_joint" value="0.7"/><joint name="wrist_3_joint" value="0.3"/>
  </group_state>
  <group_state name="far" group="wrist">
    <joint name="wrist_1_joint" value="70"/><joint name="wrist_3_joint" value="0"/>
  </group_state>
  <disable_collisions link1="base_link" link2="shoulder_link" reason="Adjacent"/>
</robot>"""


@pytest.fixture
def srdf(tmp_path):
    path = tmp_path / "ur5e.srdf"
    path.write_text(SRDF, encoding="utf-8")
    return str(path)


def test_groups_are_listed_with_what_is_wrong(srdf, capsys):
    assert main(["groups", "ur5e", "--srdf", srdf]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "base_link to tool0" in shown
    assert "no one chain" in shown
    assert "far (unusable)" in shown
    assert "end effector 'cup': group 'wrist' on link 'tool0'" in shown
    assert "link pairs without collisions: 1" in shown
    assert "line 10: group_state 'far' of group 'wrist': joint 'wrist_1_joint' is at 70" in shown


def test_an_srdf_none_of_whose_groups_fits_is_refused(srdf, tmp_path, capsys):
    assert main(["groups", "puma560", "--srdf", srdf]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "line 3: joint 'wrist_1_joint': name is 'wrist_1_joint' (did you" in shown
    lines = SRDF.splitlines()
    other = tmp_path / "wrist.srdf"
    other.write_text("\n".join(lines[:1] + lines[2:3] + lines[-1:]), encoding="utf-8")
    assert main(["groups", "puma560", "--srdf", str(other)]) == 2
    assert "none of its groups is one of 'puma560'; " in capsys.readouterr().err


@pytest.mark.slow
def test_a_named_posture_is_drawn(srdf, tmp_path, capsys):
    picture = str(tmp_path / "up.svg")
    given = ["plot", "ur5e", "--srdf", srdf, "--output", picture]
    assert main([*given, "--posture", "up"]) == 0
    assert capsys.readouterr().out == f"{picture}: 8 postures; these are all\n"
    assert main([*given, "--posture", "upp"]) == 2
    assert "posture is 'upp', expected one of home, up" in capsys.readouterr().err
