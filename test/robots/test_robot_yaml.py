"""Robots in YAML: unknown and missing keys, values out of place, hostile documents."""

import logging
from pathlib import Path

import numpy as np
import pytest
import yaml
from counting import lines_executed

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, list_robots, load_description, load_robot
from robomech_ros.robots.documents.reported_notes import report_once
from robomech_ros.robots.robot_yaml import description_from_yaml, with_yaml_limits

GOOD = """name: arm
source: a test
base_link: floor
tip_link: hand
base: {xyz: [0, 0, 1]}
tool: {xyz: [0.5, 0, 0], rpy: [0, 0, 0.5]}
joints:
  - {name: turn, type: revolute, a: 1, b: 0, alpha: 0, theta: 0.1, lower: -1, upper: 2}
  - {name: slide, type: prismatic, a: 0, b: .5, alpha: 0, lower: 0, upper: 1e-1, velocity: 1}
  - {name: spin, type: continuous, a: 0, b: 0, alpha: 0, acceleration: 5, jerk: 6, effort: 7}
"""


def test_a_good_document():
    chain = load_robot(GOOD)
    assert chain.joint_names == ("turn", "slide", "spin")
    assert chain.links == ("floor", "link_1", "link_2", "link_3", "hand")
    assert chain.types.tolist() == [0, 1, 0]
    assert chain.lower.tolist() == [-1, 0, -np.inf]
    assert chain.upper.tolist() == [2, 0.1, np.inf]
    assert [chain.velocity[1], chain.acceleration[2], chain.jerk[2], chain.effort[2]] == [
        1,
        5,
        6,
        7,
    ]
    assert np.isnan(chain.velocity[[0, 2]]).all()
    T = forward_kinematics(chain, [-0.1, 0.25, 0.0])
    np.testing.assert_allclose(T[:3, 3], [1.5, 0, 1.75], atol=1e-15)
    assert T[1, 0] == pytest.approx(np.sin(0.5))
    assert chain.dh.theta.tolist() == [0.1, 0, 0]
    part = load_robot(GOOD, base="link_1", tip="link_2")
    assert part.joint_names == ("slide",)
    np.testing.assert_allclose(part.dh.b, [0.5])


def test_numbers_follow_yaml_1_2():
    """PyYAML by itself reads 1e3 as text and 1:30 as ninety."""
    chain = load_robot(GOOD.replace("upper: 2", "upper: 1e3"))
    assert chain.upper[0] == 1000.0
    with pytest.raises(RobotDescriptionError, match="upper is '1:30', expected a finite number"):
        load_robot(GOOD.replace("upper: 2", "upper: 1:30"))


@pytest.mark.parametrize(
    ("old", "new", "expected", "where"),
    [
        ("name: arm", "nam: arm", "unknown key 'nam'; allowed: name, joints, source, units", ""),
        ("name: arm", "name: arm\nname: arm", "the key 'name' is given twice", "line 2, column 1"),
        ("a: 1,", "", "missing key 'a'; allowed: name, type, a, alpha, b, d", "joint 1"),
        ("a: 1,", "A: 1,", "unknown key 'A'; allowed", "joint 1"),
        (
            "name: arm",
            "name: arm\n"
            "floating_base: {mass: 0, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}",
            "its mass is 0 kg, expected a positive number",
            "floating_base",
        ),
        ("name: arm", "name: arm\nfloating_base: {mass: 1}", "missing key 'com'", "floating_base"),
        ("a: 1,", "a: one,", "a is 'one', expected a finite number", "joint 1 ('turn')"),
        ("a: 1,", "a: .nan,", "a is 'nan', expected a finite number", "joint 1 ('turn')"),
        ("a: 1,", "a: -.inf,", "a is '-inf'", "joint 1 ('turn')"),
        ("a: 1,", "a: 1e999,", "a is 'inf'", "joint 1 ('turn')"),
        ("a: 1,", "a: 2e6,", "a is 2e[+]06, at most 1e6 is allowed", "joint 1 ('turn')"),
        ("a: 1,", "a: true,", "a is 'True'", "joint 1 ('turn')"),
        ("a: 1,", "a: ,", "a is 'None'", "joint 1 ('turn')"),
        ("a: 1,", "a: [1],", r"a is '\[1\]'", "joint 1 ('turn')"),
        ("a: 1,", f"a: {'9' * 5000},", "a is 'inf'", "joint 1 ('turn')"),
        ("type: revolute", "type: screw", "type is 'screw', expected one of revolute, co", "turn"),
        (
            "lower: -1, ",
            "",
            "a revolute joint needs lower and upper; write type continuous",
            "turn",
        ),
        ("lower: 0, upper: 1e-1, ", "", "a prismatic joint needs lower and upper", "slide"),
        ("acceleration: 5", "lower: 5", "a continuous joint has no lower and upper", "spin"),
        ("upper: 2", "upper: -2", "lower -1 is above upper -2", "turn"),
        ("velocity: 1", "velocity: 0", "velocity limit is 0, expected a positive", "slide"),
        ("jerk: 6", "jerk: -6", "jerk limit is -6, expected a positive number", "spin"),
        ("name: slide", "name: turn", "'turn' is given twice", "joints"),
        ("name: slide", "name: ''", "'', expected a text", "joint 2: name"),
        ("name: slide", "name: 7", "'7', expected a text", "joint 2: name"),
        ("name: slide", f"name: {'x' * 300}", "longer than 256", "joint 2: name"),
        ("tip_link: hand", "tip_link: floor", "base_link and tip_link is .*floor", ""),
        ("tip_link: hand", "tip_link: link_1", "names that differ from each other and from", ""),
        ("[0, 0, 1]", "[0, 0, 1e7]", "at most 1e6 is allowed", "base"),
        ("[0, 0, 1]", "[0, 0]", "xyz must be a list of three numbers", "base"),
        ("[0, 0, 1]", "[0, 0, x]", "xyz is 'x', expected a finite number", "base"),
        (
            "xyz: [0, 0, 1]",
            "quaternion: [0, 0, 0, 1]",
            "unknown key 'quaternion'; allowed: xyz",
            "",
        ),
        ("name: arm", "name: [arm]", "expected a text", "name"),
        ("source: a test", "source:", "expected a text", "source"),
    ],
)
def test_bad_values_are_named_with_what_is_allowed(old, new, expected, where):
    assert old in GOOD
    with pytest.raises(RobotDescriptionError, match=expected) as caught:
        load_robot(GOOD.replace(old, new, 1))
    assert caught.value.where.startswith("YAML string")
    assert where in caught.value.where


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("- a\n- b\n", "the top level is list, expected keys and values"),
        ("# nothing\n# here\n", "the top level is nothing"),
        ("a: b\nc\n", "could not find expected ':'"),
        ("a: b\nc: [\n", "expected the node content"),
        ("name: a\nsource: b\njoints: 3\n", "expected a list of joints"),
        ("name: a\nsource: b\njoints: []\n", "expected a list of joints"),
        ("name: a\nsource: b\njoints: [3]\n", "expected a mapping with the keys name, type"),
        ("name: a\nsource: b\njoints:\n" + "- {}\n" * 65, "65, at most 64 are allowed"),
        ("[a, b]: c\nd: e\n", "a key must be plain text"),
        ("name: a\nsource: b\n--- \nname: c\n", "but found another document"),
    ],
)
def test_documents_of_another_shape(text, expected):
    with pytest.raises(RobotDescriptionError, match=expected):
        load_robot(text)


BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{new}: &{new} [{', '.join([f'*{old}'] * 9)}]\n"
    for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (BOMB, r"aliases \(\*name\) are not allowed"),
        ("a: &a\n  b: *a\n", "aliases"),
        ("a: 1\n<<: *a\n", "aliases|undefined alias"),
        ("a: !!python/object/apply:os.system ['true']\nb: c\n", r"tags \(!name\) are not allowed"),
        ("a: !!python/name:os.system\nb: c\n", r"tags \(!name\) are not allowed"),
        ("a: " + "[" * 20_000 + "\n", "nested deeper than 12"),
        ("a: " + "{b: " * 20_000 + "\n", "nested deeper than 12"),
        (
            "a:\n" + "".join(" " * i + "- \n" for i in range(1, 40)),
            "nested deeper|not readable|expec",
        ),
        ("a: b\n" + "#" * 300_000, "bytes, at most 262144 are allowed"),
        ("a: b\n\x00", "not readable as YAML"),
        ("a: !!timestamp 2001-99-99\nb: c\n", r"tags \(!name\) are not allowed"),
        ("a: !!int x\nb: c\n", r"tags \(!name\) are not allowed"),
        ("a: !!binary '='\nb: c\n", r"tags \(!name\) are not allowed"),
    ],
)
def test_hostile_documents_are_refused_at_once(text, expected):
    def refused():
        with pytest.raises(RobotDescriptionError, match=expected):
            load_robot(text)

    reader = str(Path(yaml.__file__).parent)
    # The reader looks ahead by 1024 characters, whatever the length.
    assert lines_executed(refused, also=(reader,)) < 20_000_000


def test_bytes_that_are_no_text(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_bytes(b"name: \xff\xfe\n")
    with pytest.raises(RobotDescriptionError, match="not readable as YAML") as caught:
        load_robot(path)
    assert caught.value.where == str(path)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("source: s\njoints: {elbow: {jerk: 1}}", "has only: shoulder_pan_joint, shoulder_lift"),
        ("source: s\njoints: {elbow_joint: {jerks: 1}}", "unknown key 'jerks'; allowed: accelerat"),
        ("source: s\njoints: {elbow_joint: {velocity: 1}}", "unknown key 'velocity'"),
        ("source: s\njoints: {elbow_joint: {jerk: 0}}", "jerk limit is 0, expected a positive"),
        ("source: s\njoints: {elbow_joint: {jerk: .inf}}", "jerk is 'inf'"),
        ("source: s\njoints: {elbow_joint: 3}", "expected a mapping with the keys acceleration"),
        ("source: s\njoints: [elbow_joint]", "expected joint names, each with acceleration"),
        ("source: s\nlimits: {}", "unknown key 'limits'; allowed: source, name, notes, joints"),
    ],
)
def test_bad_limits_beside_a_urdf(text, expected):
    with pytest.raises(RobotDescriptionError, match=expected) as caught:
        with_yaml_limits(load_description("ur5e"), text, "arm.yaml")
    assert caught.value.where.startswith("arm.yaml")


def test_every_truncation_and_every_dropped_line_is_answered():
    lines = GOOD.splitlines()
    damaged = [GOOD[:cut] for cut in range(1, len(GOOD))]
    damaged += ["\n".join(lines[:i] + lines[i + 1 :]) for i in range(len(lines))]
    for document in damaged:
        try:
            chain = description_from_yaml(document).chain()
        except RobotDescriptionError:
            continue
        assert np.isfinite(chain.packed).all()


DEGREES = """
name: arm
units: degrees
tool: {rpy: [0, 0, 90], xyz: [0.1, 0, 0]}
joints:
  - {name: turn, type: revolute, a: 0.4, d: 0.2, alpha: 90, theta: 30, lower: -170, upper: 170,
     velocity: 180, acceleration: 360, jerk: 720}
  - {name: slide, type: prismatic, a: 0, b: 0, alpha: -90, theta: 45, lower: -1, upper: 1,
     velocity: 2}
home: {turn: 90, slide: 0.5}
"""
RADIANS = """
name: arm
source: the same
tool: {rpy: [0, 0, 1.5707963267948966], xyz: [0.1, 0, 0]}
joints:
  - {name: turn, type: revolute, a: 0.4, b: 0.2, alpha: 1.5707963267948966,
     theta: 0.5235987755982988, lower: -2.9670597283903604, upper: 2.9670597283903604,
     velocity: 3.141592653589793, acceleration: 6.283185307179586, jerk: 12.566370614359172}
  - {name: slide, type: prismatic, a: 0, b: 0, alpha: -1.5707963267948966,
     theta: 0.7853981633974483, lower: -1, upper: 1, velocity: 2}
home: {turn: 1.5707963267948966, slide: 0.5}
"""


def test_a_table_in_degrees_with_d_and_without_a_source():
    one, other = load_description(DEGREES), load_description(RADIANS)
    assert (one.source, other.source, one.notes) == ("", "the same", ())
    first, second = one.chain(), other.chain()
    for field in ("packed", "lower", "upper", "velocity", "acceleration", "jerk"):
        np.testing.assert_allclose(getattr(first, field), getattr(second, field), atol=1e-15)
    np.testing.assert_allclose(first.home(), second.home(), atol=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("units: degrees", "units: grads", "units: 'grads', expected radians, degrees"),
        ("d: 0.2,", "d: 0.2, b: 0.2,", "needs exactly one of b and d"),
        ("d: 0.2,", "", "joint 1.*: needs exactly one of b and d"),
        ("lower: -170", "lower: \uff11", "lower is '\uff11', expected a finite number"),
    ],
)
def test_units_and_offsets_that_are_none(old, new, expected):
    with pytest.raises(RobotDescriptionError, match=expected):
        load_description(DEGREES.replace(old, new))


def test_angles_that_are_hardly_in_radians_are_named_once(caplog):
    report_once.cache_clear()
    text = DEGREES.replace("units: degrees\n", "").replace("home: {turn: 90", "home: {turn: 2")
    with caplog.at_level(logging.WARNING):
        notes = load_description(text).notes
        load_description(text)
    starts = [note.partition(" rad")[0] for note in notes]
    assert starts == [
        "joint 'turn': alpha of 90",
        "joint 'slide': alpha of -90",
        "joint 'turn': theta of 30",
        "joint 'slide': theta of 45",
        "joint 'turn': a limit of 170",
    ]
    assert sorted(caplog.messages) == sorted(notes)
    caplog.clear()
    chain_from_dh([1.0, 1.0], [0.0, 0.0], [90.0, 0.0], joint_names=["one", "two"])
    assert caplog.messages[0].startswith("joint 'one': alpha of 90 rad is more than a turn")


@pytest.mark.parametrize("name", list_robots())
def test_the_robots_of_the_library_say_where_they_come_from_and_have_nothing_odd(name):
    description = load_description(name)
    assert len(description.source) > 10
    assert description.notes == ()
