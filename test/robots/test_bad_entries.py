"""Robots as they arrive: one bad entry is named, and only what needs it is refused."""

import logging
import math
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_description, load_robot, load_srdf, urdf_from_description
from robomech_ros.robots.documents.guarded_xml import parse_xml
from robomech_ros.robots.documents.reported_notes import report_once
from robomech_ros.robots.fingers import finger_joints

FIELD = Path(__file__).parents[1] / "data/field"
REACHED = [[0.3 * math.cos(0.5)], [0.3 * math.sin(0.5)], [0.0]]


def reached(chain):
    return forward_kinematics(chain, [0.5])[:3, 3:]


@pytest.mark.parametrize("name", ["mimic_of_nothing", "velocity_minus_one", "latin1_comment"])
def test_what_urdfdom_reads_is_read(name):
    np.testing.assert_allclose(reached(load_robot(FIELD / f"{name}.urdf", tip="tool0")), REACHED)


def test_a_joint_that_follows_none_is_refused_on_a_chain_only(caplog):
    report_once.cache_clear()
    with caplog.at_level(logging.WARNING):
        description = load_description(FIELD / "mimic_of_nothing.urdf")
        load_description(FIELD / "mimic_of_nothing.urdf")
    (note,) = description.notes
    assert "joint 'finger_end': <mimic> names joint 'finger_root'" in note
    assert caplog.messages == [note]
    with pytest.raises(RobotDescriptionError, match="joint 'finger_end': <mimic> names joint 'fin"):
        description.chain(tip="finger")
    # It stands still, and is no finger of a gripper.
    assert finger_joints(description, description.chain(tip="tool0")) == ()
    assert description.joint_positions()["finger_end"] == 0.0


def test_limits_of_minus_one_count_as_missing():
    description = load_description(FIELD / "velocity_minus_one.urdf")
    chain = description.chain()
    assert np.isnan(chain.velocity).all() and np.isnan(chain.effort).all()
    assert (chain.lower[0], chain.upper[0]) == (-2.0, 2.0)
    assert [note.partition("'j1': ")[2] for note in description.notes] == [
        "velocity limit is -1, which counts as missing",
        "effort limit is -1, which counts as missing",
    ]


BESIDE = (
    '<link name="beside"/><joint name="k" type="revolute"><parent link="l1"/><child link="beside"/>'
    '{}<limit lower="{}" upper="{}" effort="1" velocity="1"/></joint></robot>'
)


@pytest.mark.parametrize(
    ("entry", "why"),
    [
        (BESIDE.format("", 1, -1), "lower limit 1 is above upper limit -1"),
        (BESIDE.format('<axis xyz="0 0 0"/>', -1, 1), "axis is '0 0 0', of zero length"),
        (BESIDE.format('<dynamics damping="-1"/>', -1, 1), "damping is -1"),
        (BESIDE.format('<dynamics damping="few"/>', -1, 1), "damping of <dynamics> is 'few'"),
        (BESIDE.format("", "\uff11", 2), "lower of <limit> is '\uff11', expected a finite number"),
    ],
)
def test_a_wrong_joint_beside_the_arm_does_not_matter_to_it(entry, why):
    text = (FIELD / "latin1_comment.urdf").read_text("latin-1").replace("</robot>", entry)
    description = load_description(text)
    np.testing.assert_allclose(reached(description.chain(tip="tool0")), REACHED)
    (note,) = description.notes
    assert why in note and "joint 'k'" in note
    with pytest.raises(RobotDescriptionError, match="joint 'k'"):
        description.chain(tip="beside")
    # It is written and read again with the same fault.
    assert load_description(urdf_from_description(description)).notes[0].endswith(note[-40:])


@pytest.mark.parametrize(
    "comment",
    ["a -- b", "--", "----- joints -----", " ends with -", "-", "", "<link name='x'/> -- ]]>"],
)
def test_comments_with_double_hyphens(comment):
    text = (
        (FIELD / "latin1_comment.urdf").read_text("latin-1").replace(" turned by 90\xb0 ", comment)
    )
    assert load_robot(text, tip="tool0").n == 1
    # What is published can be read by every parser of XML.
    parse_xml(load_description(text).document, "published")


def test_hyphens_outside_of_comments_stay():
    element = parse_xml("<!-- a --><r a='--1' b='-->'/><!-- b -- -->", "x")
    assert element.attributes == {"a": "--1", "b": "-->"}


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "utf-8", "utf-16"])
def test_names_in_other_encodings(encoding, tmp_path):
    declared = "" if encoding in ("latin-1", "utf-8") else f' encoding="{encoding}"'
    text = (FIELD / "latin1_comment.urdf").read_text("latin-1")
    text = text.replace('version="1.0"', f'version="1.0"{declared}').replace('"j1"', '"J\xf6int"')
    path = tmp_path / "arm.urdf"
    path.write_bytes(text.encode(encoding))
    assert load_robot(path, tip="tool0").joint_names == ("J\xf6int",)


def test_encodings_that_are_no_text_are_refused():
    for encoding in ("punycode", "utf-7", "hex", "unicode_escape"):
        text = f'<?xml version="1.0" encoding="{encoding}"?><robot name="r"/>'
        with pytest.raises(RobotDescriptionError, match="unknown encoding"):
            parse_xml(text.encode(), "x")


def test_a_link_is_one_with_and_without_a_leading_slash():
    text = (FIELD / "latin1_comment.urdf").read_text("latin-1").replace('"tool0"', '"/tool0"')
    description = load_description(text)
    assert description.links == ("base", "l1", "tool0")
    for tip in ("tool0", "/tool0"):
        chain = description.chain("/base", tip)
        assert (chain.base, chain.tip) == ("base", "tool0")
        assert chain.link_frame(tip).name == chain.with_tip(tip).tip == "tool0"
    srdf = (
        '<robot name="a"><group name="g"><chain base_link="/base" tip_link="{}"/></group></robot>'
    )
    for tip in ("tool0", "/tool0"):
        assert load_srdf(srdf.format(tip), description).groups["g"].ends == ("base", "tool0")
    assert [visual for visual in urdf_from_description(description).split() if "<visual" in visual]
