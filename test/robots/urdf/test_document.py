"""URDF: how it becomes a chain, and every kind of broken or hostile document."""

import numpy as np
import pytest
from counting import lines_executed

from robomech_ros.errors import BadValueError, RobotDescriptionError, UnknownLinkError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_description, load_robot
from robomech_ros.spatial import matrix_from_axis_angle

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'


def joint(name, parent, child, kind="revolute", inside=LIMIT):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{inside}</joint>"
    )


def robot(links, *joints, extra=""):
    named = "".join(f'<link name="{link}"/>' for link in links.split())
    return f'<?xml version="1.0"?>\n<robot name="r">{named}\n{chr(10).join(joints)}{extra}</robot>'


SIMPLE = robot("a b", joint("j", "a", "b"))


def with_joint(inside, kind="revolute"):
    return robot("a b", joint("j", "a", "b", kind, inside))


def refused(text, expected, where=None):
    with pytest.raises(RobotDescriptionError, match=expected) as caught:
        load_robot(text)
    if where:
        assert where in caught.value.where
    return caught.value


# --- What becomes of a good document ---


@pytest.mark.parametrize(
    "axis",
    [
        (1, 0, 0),
        (0, 1, 0),
        (0, 0, 1),
        (-1, 0, 0),
        (0, -1, 0),
        (0, 0, -1),
        (1, 2, -3),
        (0, 1e-9, -1),
    ],
)
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_an_axis_in_any_direction(axis, kind):
    xyz = " ".join(str(10.0 * component) for component in axis)
    inside = f'<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><axis xyz="{xyz}"/>{LIMIT}'
    chain = load_robot(with_joint(inside, kind))
    origin = load_robot(with_joint(f'<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>{LIMIT}'))
    expected = forward_kinematics(origin, [0.0])
    unit = np.array(axis) / np.linalg.norm(axis)
    moved = np.eye(4)
    if kind == "revolute":
        moved[:3, :3] = matrix_from_axis_angle(axis, 0.7)
    else:
        moved[:3, 3] = 0.7 * unit
    np.testing.assert_allclose(forward_kinematics(chain, [0.7]), expected @ moved, atol=1e-15)


def test_the_axis_is_x_where_none_is_given():
    np.testing.assert_allclose(
        forward_kinematics(load_robot(SIMPLE), [0.5])[:3, :3],
        matrix_from_axis_angle([1, 0, 0], 0.5),
    )


def test_axes_along_coordinates_are_folded_without_rounding():
    chain = load_robot(with_joint(f'<axis xyz="0 -1 0"/>{LIMIT}'))
    assert set(np.unique(chain.packed[:, 1:])) <= {-1.0, 0.0, 1.0}


def test_limits_of_all_kinds_of_joint():
    text = robot(
        "a b c d",
        joint("turn", "a", "b"),
        joint("slide", "b", "c", "prismatic", '<limit upper=".5" velocity="0" effort="0"/>'),
        joint("spin", "c", "d", "continuous", '<limit velocity="5" effort="6"/>'),
    )
    chain = load_robot(text)
    assert chain.lower.tolist() == [-1.0, 0.0, -np.inf]
    assert chain.upper.tolist() == [2.0, 0.5, np.inf]
    assert chain.velocity.tolist()[::2] == [3.0, 5.0]
    assert chain.effort.tolist()[::2] == [4.0, 6.0]
    # Zero is what exporters write for a limit they do not know.
    assert np.isnan(chain.velocity[1])
    assert np.isnan(chain.effort[1])
    assert chain.continuous.tolist() == [False, False, True]
    assert chain.types.tolist() == [0, 1, 0]
    assert load_robot(with_joint("", "continuous")).continuous.all()


def test_fixed_joints_are_folded_and_side_links_kept():
    text = robot(
        "world base arm tool0 camera lens",
        joint("mount", "world", "base", "fixed", '<origin xyz="0 0 1"/>'),
        joint("j", "base", "arm", "revolute", f'<axis xyz="0 0 1"/>{LIMIT}'),
        joint("t", "arm", "tool0", "fixed", '<origin xyz="2 0 0"/>'),
        joint("c", "arm", "camera", "fixed", '<origin xyz="1 0 0"/>'),
        joint("l", "camera", "lens", "fixed", '<origin xyz="0 1 0"/>'),
    )
    chain = load_robot(text)
    assert (chain.base, chain.tip, chain.n) == ("world", "tool0", 1)
    assert forward_kinematics(chain, [0.0])[:3, 3].tolist() == [2.0, 0.0, 1.0]
    lens = chain.with_tip("lens")
    assert lens.links == ("world", "base", "arm", "camera", "lens")
    assert forward_kinematics(lens, [0.0])[:3, 3].tolist() == [1.0, 1.0, 1.0]
    assert load_robot(text, base="base").packed[0, 12] == 0.0


ASIDE = robot(
    "world floor mark base arm tool0 lens",
    joint("f", "world", "floor", "fixed", '<origin xyz="0 0 1" rpy="0 0 0.5"/>'),
    joint("m", "floor", "mark", "fixed", '<origin xyz="1 2 0" rpy="0.1 0.2 0.3"/>'),
    joint("b", "world", "base", "fixed", '<origin xyz="0 3 0"/>'),
    joint("j", "base", "arm", "revolute", f'<axis xyz="0 0 1"/>{LIMIT}'),
    joint("t", "arm", "tool0", "fixed", '<origin xyz="2 0 0"/>'),
    joint("l", "arm", "lens", "fixed", '<origin xyz="0 1 0"/>'),
)


@pytest.mark.parametrize("tip", ["tool0", "lens", "arm"])
def test_a_base_aside_that_fixed_joints_hold(tip):
    chain, whole = load_robot(ASIDE, "mark", tip), load_robot(ASIDE, tip=tip)
    assert (chain.base, chain.tip, chain.n) == ("mark", tip, 1)
    assert chain.links[:3] == ("mark", "world", "base")
    mark = forward_kinematics(whole.with_tip("mark"), [])
    for q in ([0.0], [0.7]):
        seen = mark @ forward_kinematics(chain, q)
        np.testing.assert_allclose(seen, forward_kinematics(whole, q), atol=1e-15)
    floor = forward_kinematics(chain.with_tip("floor"), [])
    same = forward_kinematics(whole.with_tip("floor"), [])
    np.testing.assert_allclose(mark @ floor, same, atol=1e-15)


def test_a_base_aside_finds_the_tip_by_itself():
    lone = ASIDE.replace('"lens"', '"flange_camera"')
    assert load_robot(lone, base="mark").tip == "tool0"
    with pytest.raises(RobotDescriptionError, match="no joint moves between link 'tool0' and"):
        load_robot(ASIDE, "tool0", "lens")
    with pytest.raises(RobotDescriptionError, match="link 'base' is not below link 'lens'"):
        load_robot(ASIDE, "lens", "base")
    for base in (3, ["mark"]):
        with pytest.raises(BadValueError, match="base is .*expected the name of a link"):
            load_robot(ASIDE, base)


GRIPPER = robot(
    "base wrist left right",
    joint("j", "base", "wrist"),
    joint("l", "wrist", "left", "prismatic"),
    joint("r", "wrist", "right", "prismatic", f'{LIMIT}<mimic joint="l" multiplier="-1"/>'),
)


def test_base_and_tip_are_chosen_or_asked_for():
    expected = "could be the tip, name one with tip= or --tip-link: wrist, left, right$"
    error = refused(GRIPPER, expected)
    assert error.where == "URDF string"
    assert load_robot(GRIPPER, tip="left").joint_names == ("j", "l")
    assert load_robot(GRIPPER, "", "wrist").joint_names == ("j",)
    assert load_robot(GRIPPER, base="wrist", tip="left").joint_names == ("l",)
    for name in ("tool0", "flange", "right_tool0"):
        marked = GRIPPER.replace('"right"', f'"{name}"').replace("<mimic", "<other")
        assert load_robot(marked).tip == name
    assert load_description(GRIPPER).links == ("base", "wrist", "left", "right")
    assert load_description(GRIPPER).root == "base"


def test_leaves_that_nothing_moves_are_no_tips():
    text = robot(
        "base plate arm", joint("p", "base", "plate", "fixed", ""), joint("j", "base", "arm")
    )
    assert load_robot(text).tip == "arm"


@pytest.mark.parametrize(
    ("base", "tip", "text"),
    [
        ("left", "base", "link 'base' is not below link 'left'"),
        ("wrist", "wrist", "no joint moves between link 'wrist' and link 'wrist'"),
        ("left", None, "no joint moves below link 'left'"),
    ],
)
def test_chains_that_do_not_exist(base, tip, text):
    with pytest.raises(RobotDescriptionError, match=text):
        load_robot(GRIPPER, base, tip)


def test_unknown_links_are_answered_with_the_known_ones():
    for base, tip in (("bas", None), (None, "lefd")):
        with pytest.raises(UnknownLinkError) as caught:
            load_robot(GRIPPER, base, tip)
        assert caught.value.available == ("base", "wrist", "left", "right")


@pytest.mark.parametrize("kind", ["planar", "floating"])
def test_other_joints_are_refused_by_name_on_the_chain_only(kind):
    text = robot("a b c", joint("j", "a", "b"), joint("odd", "b", "c", kind, ""))
    error = refused(text, f"type '{kind}' on the chain from 'a' to 'c'; a chain takes revolute")
    assert error.where == "URDF string: joint 'odd'"
    assert load_robot(text, tip="b").n == 1


def test_nothing_is_printed(capfd):
    extra = '<gazebo reference="a"><x/></gazebo><transmission/><unknown/><material name="m"/>'
    inside = '<dynamics damping="0.1" what="x"/><safety_controller k_velocity="1"/>'
    text = robot("a b", joint("j", "a", "b", "revolute", LIMIT + inside), extra=extra)
    assert load_robot(text).n == 1
    assert capfd.readouterr() == ("", "")


def test_other_encodings(tmp_path):
    path = tmp_path / "arm.urdf"
    for encoding in ("utf-8", "utf-16", "iso-8859-1"):
        text = SIMPLE.replace('"1.0"', f'"1.0" encoding="{encoding}"').replace('"j"', '"Gelenkö"')
        path.write_bytes(text.encode(encoding))
        assert load_robot(path).joint_names == ("Gelenkö",)
        assert load_robot(text).joint_names == ("Gelenkö",)


def test_a_long_tree_is_no_trouble_and_parts_of_it_are_chains():
    count = 2000
    links = " ".join(f"l{i}" for i in range(count + 1))
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}") for i in range(count)]
    description = load_description(robot(links, *joints))
    assert len(description.joints) == count
    chain = description.chain("l1900", "l1964")
    assert chain.n == 64
    assert np.isfinite(forward_kinematics(chain, np.zeros(64))).all()
    with pytest.raises(BadValueError, match="number of joints is 2000, expected at most 64"):
        load_robot(robot(links, *joints))


# --- Broken documents ---


@pytest.mark.parametrize(
    ("text", "expected", "where"),
    [
        ("<robot", "not well-formed XML: unclosed token", "line 1"),
        ("<robot name='r'>\n<link></robot>", "not well-formed XML: mismatched tag", "line 2, col"),
        ("<a/><b/>", "junk after document element", "line 1"),
        ("<?xml version='1.0'?>", "no element found", "line 1"),
        ("<sdf/>", "the root element is <sdf>, expected <robot>", "URDF string"),
        ("<robot/>", "<robot> has no name", None),
        ("<robot name='r'/>", "no link", None),
        ("<robot name='r'><link/></robot>", "a link without a name", "line 1"),
        (robot("a b a"), r"defined 2 times, in lines 2, 2", "link 'a'"),
        (robot("a b", joint("", "a", "b")), "a joint without a name", "line 3"),
        (f"<robot name='r'><link name='{'x' * 300}'/></robot>", "name longer than 256", "line 1"),
        (
            robot("a b c", joint("j", "a", "b"), joint("j", "b", "c")),
            "defined 2 times, in lines 3, 4",
            "joint 'j'",
        ),
        (robot("a b c", joint("j", "a", "b")), "several root links, expected one: 'a', 'c'", None),
        (
            robot("a b c", joint("j", "a", "b"), joint("k", "c", "b")),
            "link 'b' is already the child of joint 'j'",
            "joint 'k'",
        ),
        (
            robot("a b c", joint("j", "a", "b"), joint("k", "b", "a")),
            "link 'a' is on or below a loop",
            None,
        ),
        (
            robot("a b c d", joint("j", "a", "b"), joint("k", "c", "d"), joint("l", "d", "c")),
            "link 'c' is on or below a loop of joints",
            None,
        ),
        (robot("a", joint("j", "a", "a")), "link 'a' is on or below a loop", None),
        (robot("a b", joint("j", "x", "b")), "its parent link 'x' does not exist", "joint 'j'"),
        (robot("a b", joint("j", "a", "x")), "its child link 'x' does not exist", "joint 'j'"),
        (
            robot("a b", joint("j", "a", "b", "helical")),
            "'helical', expected one of revolute, cont",
            "line 3: joint 'j'",
        ),
        (robot("a b", joint("j", "a", "b", "")), "type is '', expected one of", None),
        (SIMPLE.replace('<parent link="a"/>', ""), "<parent> is missing", "joint 'j'"),
        (SIMPLE.replace('<parent link="a"/>', "<parent/>"), "<parent> names no link", None),
        (with_joint(f'{LIMIT}<child link="b"/>'), "<child> given 2 times", None),
        (with_joint(LIMIT + LIMIT), "<limit> given 2 times", None),
        (with_joint(""), "<limit> is missing", "joint 'j'"),
        (with_joint("", "prismatic"), "<limit> is missing", None),
        (with_joint('<limit velocity="1"/>'), "<limit> has no effort", None),
        (with_joint('<limit effort="1"/>'), "<limit> has no velocity", None),
        (
            with_joint('<limit lower="1" upper="-1" velocity="1" effort="1"/>'),
            "lower limit 1 is above upper limit -1",
            None,
        ),
        (
            with_joint(LIMIT.replace("-1", "nan")),
            "lower of <limit> is 'nan', expected a finite",
            None,
        ),
        (with_joint(LIMIT.replace("-1", "-inf")), "'-inf', expected a finite number", None),
        (with_joint(LIMIT.replace("-1", "1e999")), "'1e999', expected a finite number", None),
        (with_joint(LIMIT.replace("-1", "1_0")), "'1_0', expected a finite number", None),
        (with_joint(LIMIT.replace("-1", "")), "lower of <limit> is '', expected a finite", None),
        (with_joint(LIMIT + '<axis xyz="0 0 0"/>'), "axis is '0 0 0', of zero length", None),
        (
            with_joint(LIMIT + '<axis xyz="0 1"/>'),
            "xyz of <axis> is '0 1', expected 3 finite",
            None,
        ),
        (with_joint(LIMIT + '<axis xyz="0 inf 0"/>'), "expected 3 finite numbers", None),
        (with_joint(LIMIT + '<origin xyz="a b c"/>'), "xyz of <origin> is 'a b c'", None),
        (with_joint(LIMIT + '<origin rpy="0 0 0 0"/>'), "rpy of <origin> is '0 0 0 0'", None),
        (with_joint(LIMIT + "<mimic/>"), "<mimic> names no joint", None),
        (
            robot("a", extra='<xacro:include filename="b"/>'),
            "expand it first, with `xacro",
            "line 3",
        ),
        ("<robot name='r'>\udc80</robot>", "not valid text", None),
    ],
)
def test_broken_documents(text, expected, where):
    refused(text, expected, where)


def test_lengths_and_limits_out_of_all_proportion():
    text = with_joint(LIMIT + '<origin xyz="0 -2e6 0"/>')
    refused(text, "xyz of <origin> is '0 -2e6 0', at most 1e6 is allowed", "joint 'j'")
    text = with_joint(LIMIT.replace('"-1"', '"-1e16"').replace('"2"', '"1e16"'))
    assert load_robot(text).continuous.all()


# --- Hostile documents ---

LAUGHS = """<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY lol "lol">
<!ENTITY lol1 "&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;&lol;">
<!ENTITY lol2 "&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;&lol1;">]>
<robot name="&lol2;"/>"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (LAUGHS, "a document type declaration .* is not allowed"),
        ('<!DOCTYPE r SYSTEM "http://localhost:1/x.dtd"><robot name="r"/>', "document type"),
        (
            '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="r">&x;</robot>',
            "document type",
        ),
        (
            '<!DOCTYPE r [<!ENTITY % x SYSTEM "file:///etc/passwd"> %x;]><robot name="r"/>',
            "document",
        ),
        ('<!DOCTYPE robot><robot name="r"/>', "document type"),
        ('<robot name="&undefined;"/>', "not well-formed XML: undefined entity"),
        ("<robot name='r'>" + "<a>" * 100, "elements nested deeper than 64"),
        ("<robot name='r'>" + "<a/>" * 250_000 + "</robot>", "more than 50000 elements"),
        ("<robot name='" + "x" * 9_000_000 + "'/>", "bytes, at most 8388608 are allowed"),
        ('<?xml version="1.0" encoding="utf-7"?>+ADw-robot/+AD4-', "not well-formed|encoding"),
    ],
)
def test_hostile_documents_are_refused_at_once(text, expected):
    # Whatever they hold, it is less work than reading the largest document that is allowed.
    assert lines_executed(refused, text, expected, "URDF string") < 1_000_000


def test_hostile_files(tmp_path):
    path = tmp_path / "arm.urdf"
    utf16 = (
        '<?xml version="1.0" encoding="UTF-16"?><!DOCTYPE r [<!ENTITY a "b">]><robot name="&a;"/>'
    )
    cases = {
        utf16.encode("utf-16"): "document type",
        b'<?xml version="1.0" encoding="no-such"?><robot name="r"/>': "unknown encoding",
        b"\x00\x01\x02": "not well-formed",
        b"<robot name='\xff\xfe'/>": "no link",
        b" " * 9_000_000: "more than 8388608 bytes",
    }
    for data, expected in cases.items():
        path.write_bytes(data)
        with pytest.raises(RobotDescriptionError, match=expected) as caught:
            load_robot(path)
        assert str(path) in caught.value.where


def test_messages_stay_short_and_printable():
    text = robot("a b", joint("j", "a", "b", "x" * 100_000))
    assert len(str(refused(text, "expected one of"))) < 500
    many = " ".join(f"l{i}" for i in range(5000))
    assert len(str(refused(robot(many), "several root links"))) < 500
    with pytest.raises(UnknownLinkError) as caught:
        load_robot(SIMPLE, tip="\x1b[31m\n" + "y" * 10_000)
    assert len(str(caught.value)) < 1000
    assert "\x1b" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_every_truncation_and_every_dropped_line_is_answered():
    with open(load_description("ur5e").where, encoding="utf-8") as file:
        text = file.read()
    lines = text.splitlines()
    damaged = [text[:cut] for cut in range(1, len(text), 97)]
    damaged += ["\n".join(lines[:i] + lines[i + 1 :]) for i in range(len(lines))]
    for document in damaged:
        try:
            chain = load_robot(document)
        except RobotDescriptionError:
            continue
        assert np.isfinite(chain.packed).all()
