"""Printed form of chains, results and models."""

import numpy as np
import pytest

from robomech_ros.hands import Contact, grasp_quality
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import singularity_report, workspace_boundary
from robomech_ros.parallel import load_parallel
from robomech_ros.printing import brief
from robomech_ros.robots import list_robots, load_description, load_robot, load_semantics

PUMA = load_robot("puma560")
T = forward_kinematics(PUMA, PUMA.home())
FAR = T + np.diag([0.0, 0.0, 5.0], 1)
FINGERS = [
    Contact([np.cos(a), np.sin(a), 0.0], [-np.cos(a), -np.sin(a), 0.0], "point", 0.5)
    for a in (0.0, 2.1, 4.2)
]

PRINTED = {
    "chain": lambda: PUMA,
    "long chain": lambda: load_robot("general7r"),
    "solutions": lambda: inverse_kinematics(PUMA, T),
    "many solutions": lambda: inverse_kinematics(load_robot("general7r"), _reached("general7r")),
    "no solution": lambda: inverse_kinematics(PUMA, FAR),
    "table": lambda: PUMA.dh,
    "description": lambda: load_description("panda"),
    "groups": lambda: load_semantics(load_description("panda")),
    "singularity": lambda: singularity_report(PUMA, PUMA.midrange()),
    "workspace": lambda: workspace_boundary(PUMA),
    "grasp": lambda: grasp_quality(FINGERS, length=1.0),
    "platform": lambda: load_parallel("delta").direct([0.3, 0.4, 0.5]),
}


def _reached(name):
    arm = load_robot(name)
    return forward_kinematics(arm, arm.home())


@pytest.mark.parametrize("what", PRINTED)
def test_what_is_printed_is_short_and_says_something(what):
    value = PRINTED[what]()
    lines = str(value).splitlines()
    assert 1 < len(lines) <= 10
    assert all(len(line) <= 200 and line == line.rstrip() for line in lines)
    assert " at 0x" not in str(value) and "array(" not in str(value)
    assert "\n" not in repr(value) and len(repr(value)) <= 150


@pytest.mark.parametrize("name", list_robots())
def test_every_chain_says_its_ends_and_its_joints(name):
    chain = load_robot(name)
    head, *rows = str(chain).splitlines()
    assert head == f"{chain.name}: {chain.n} joints, {chain.base} to {chain.tip}"
    assert [row.split(":")[0].strip() for row in rows] == list(chain.joint_names)


def test_solutions_say_how_many_which_and_why_not():
    lines = str(inverse_kinematics(PUMA, T)).splitlines()
    assert lines[0] == "2 solutions of puma560, these are all (decoupled, SUCCESS)"
    assert "shoulder" in lines[1] and lines[1].count(",") == 5
    assert "out of reach by" in str(inverse_kinematics(PUMA, FAR))
    many = str(PRINTED["many solutions"]()).splitlines()
    assert many[-1].startswith("  and ") and many[-1].endswith(" more, in q")


def test_long_chains_are_cut():
    from robomech_ros.robots import chain_from_dh

    lines = str(chain_from_dh([0.1] * 12, [0.0] * 12, [0.5] * 12)).splitlines()
    assert len(lines) == 10 and lines[-1] == "  and 4 more"


def test_values_in_brief():
    assert brief(np.array([-5e-17, 1.23456])) == "[0, 1.235]"
    assert brief(np.zeros((3, 4))) == "array of shape (3, 4)"
    assert brief({"a": 1.0, "b": (2, 3)}) == "a: 1, b: 2, 3"
    assert brief("one\ntwo") == "one two"
    assert brief(()) == brief(None) == brief(np.zeros(0)) == ""
    assert brief(tuple(range(100))) == "100 entries"
