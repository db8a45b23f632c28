"""The chain model: its links, other tips, limits, and that nobody can change it."""

import pickle

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    MissingLimitsError,
    NonFiniteError,
    UnknownLinkError,
    WrongSizeError,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import SerialChain, chain_from_dh, load_robot


def two_joints(**changes):
    values = {
        "name": "two",
        "base": "base",
        "tip": "tip",
        "joint_names": ("one", "other"),
        "types": [0, 1],
        "packed": np.tile([0.0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0], (3, 1)),
        "lower": [-np.inf, 0.0],
        "upper": [np.inf, 1.0],
        **{kind: [np.nan, 1.0] for kind in ("velocity", "acceleration", "jerk", "effort")},
        **changes,
    }
    return SerialChain(**values)


def test_nobody_can_change_a_chain():
    chain = load_robot("puma560")
    with pytest.raises(AttributeError):
        chain.name = "other"
    for field in ("packed", "lower", "upper", "velocity", "types", "continuous"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(chain, field)[0] = 0
    given = np.array([0.0, 0.0])
    made = two_joints(lower=given)
    given[0] = 5.0
    assert made.lower[0] == 0.0


def test_chains_are_keys_and_survive_pickling():
    chain = load_robot("ur5e")
    assert {chain: 1}[chain] == 1
    assert chain != load_robot("ur5e")
    again = pickle.loads(pickle.dumps(chain))
    assert again.packed.tobytes() == chain.packed.tobytes()
    assert again.links == chain.links


def test_links_and_other_tips():
    chain = load_robot("ur5e")
    assert chain.links[0] == chain.base == "base_link"
    assert chain.links[-1] == chain.tip == "tool0"
    assert "base" not in chain.links
    elbow = chain.with_tip("forearm_link")
    assert elbow.joint_names == chain.joint_names[:3]
    assert elbow.links == chain.links[: chain.links.index("forearm_link") + 1]
    assert elbow.lower.tolist() == chain.lower[:3].tolist()
    assert chain.with_tip("forearm_link") is elbow
    assert chain.with_tip("tool0") is chain
    aside = chain.with_tip("base")
    assert (aside.n, aside.links, aside.dh) == (0, ("base_link", "base"), None)
    np.testing.assert_allclose(forward_kinematics(aside, []), np.diag([-1, -1, 1, 1]), atol=2e-16)
    with pytest.raises(UnknownLinkError) as caught:
        elbow.with_tip("tool0")
    assert "forearm_link" in caught.value.available


def test_a_tip_further_on_is_reached_from_a_tip_before_it():
    flange = load_robot("ur5e", tip="flange")
    whole = load_robot("ur5e")
    q = np.arange(6.0)
    there = forward_kinematics(flange.with_tip("tool0"), q)
    np.testing.assert_array_equal(there, forward_kinematics(whole, q))
    assert flange.with_tip("tool0").links == whole.links


def test_which_joints_are_continuous():
    assert two_joints().continuous.tolist() == [True, False]
    assert two_joints(lower=[-1, -np.inf], upper=[np.inf, np.inf]).continuous.tolist() == [
        False,
        False,
    ]


def test_midrange_is_within_the_limits():
    chain = two_joints(
        joint_names=tuple("abcde"),
        types=[0] * 5,
        packed=np.tile(two_joints().packed[:1], (6, 1)),
        lower=[-np.inf, 1.0, 2.0, -np.inf, -3.0],
        upper=[np.inf, 3.0, np.inf, -4.0, np.inf],
        **{kind: [1.0] * 5 for kind in ("velocity", "acceleration", "jerk", "effort")},
    )
    assert chain.midrange().tolist() == [0.0, 2.0, 2.0, -4.0, 0.0]


@pytest.mark.parametrize("kind", ["velocity", "acceleration", "jerk", "effort"])
def test_missing_limits_are_named_by_joint(kind):
    with pytest.raises(MissingLimitsError, match=f"no {kind} limit for joint one$") as caught:
        two_joints().require_limits(kind)
    assert (caught.value.kind, caught.value.joints) == (kind, ("one",))
    two_joints(**{kind: [1.0, 1.0]}).require_limits(kind)


def test_a_continuous_joint_lacks_no_position_limit():
    two_joints().require_limits("position")
    with pytest.raises(MissingLimitsError, match="no position limit for joint other"):
        two_joints(upper=[np.inf, np.inf]).require_limits("position")
    with pytest.raises(BadValueError, match="'force', expected position, velocity"):
        two_joints().require_limits("force")


@pytest.mark.parametrize(
    ("changes", "error", "text"),
    [
        ({"joint_names": ("one", "one")}, BadValueError, "different names"),
        ({"lower": [0.0]}, WrongSizeError, r"lower has shape \(1,\), expected \(2,\)"),
        ({"packed": np.zeros((2, 13))}, WrongSizeError, r"packed has shape \(2, 13\)"),
        ({"packed": np.full((3, 13), np.inf)}, NonFiniteError, r"packed\[0, 0\] is inf"),
        ({"packed": np.full((3, 13), 1e300)}, BadValueError, "longest offset is 1e[+]300"),
        ({"types": [0, 2]}, BadValueError, "types is .*0 .revolute. or 1 .prismatic."),
        ({"joint_names": "ab"}, BadValueError, "joint_names is 'ab', expected a list of names"),
        ({"joint_names": ("one", None)}, BadValueError, "one of joint_names is None"),
        ({"tip": ""}, BadValueError, "tip is '', expected a name"),
        ({"lower": [np.nan, 0]}, NonFiniteError, r"limits lower\[0\] is nan"),
        ({"lower": [2, 0], "upper": [1, 1]}, BadValueError, "limits of joint 'one' is .2.0, 1.0."),
        ({"lower": [np.inf, 0], "upper": [np.inf, 1]}, BadValueError, "'one' is .inf, inf."),
        ({"lower": [-np.inf, 0], "upper": [-np.inf, 1]}, BadValueError, "'one' is .-inf, -inf."),
        ({"lower": [1e9, 0], "upper": [2e9, 1]}, BadValueError, "positions between -100000 and"),
        ({"jerk": [0.0, 1.0]}, BadValueError, "jerk limit of joint 'one' is 0.0"),
    ],
)
def test_an_inconsistent_chain_cannot_be_made(changes, error, text):
    with pytest.raises(error, match=text):
        two_joints(**changes)


def test_limits_too_far_out_to_matter_are_none():
    chain = two_joints(lower=[-1e16, -1e5], upper=[1e16, 1e5])
    assert np.isinf(chain.lower).all() and np.isinf(chain.upper).all()
    assert chain.continuous.tolist() == [True, False]


@pytest.mark.parametrize(
    ("limits", "lower", "upper"),
    [
        (None, [-np.inf, -np.inf], [np.inf, np.inf]),
        ([[-1, 1], [0, 2]], [-1, 0], [1, 2]),
        (np.array([[-1, 1], [0, 2]]), [-1, 0], [1, 2]),
        ([(None, None), (0, None)], [-np.inf, 0], [np.inf, np.inf]),
        ({"lower": -1, "upper": [1, 2]}, [-1, -1], [1, 2]),
        ({"lower": None, "upper": [None, 2]}, [-np.inf, -np.inf], [np.inf, 2]),
        ({}, [-np.inf, -np.inf], [np.inf, np.inf]),
    ],
)
def test_limits_as_users_write_them(limits, lower, upper):
    chain = chain_from_dh([1, 2], [0, 0], [0, 0], limits=limits)
    assert (chain.lower.tolist(), chain.upper.tolist()) == (lower, upper)


def test_other_limits_may_be_one_number_or_lack():
    chain = chain_from_dh(
        [1, 2], [0, 0], [0, 0], limits={"velocity": 3, "jerk": [None, 4], "effort": None}
    )
    assert chain.velocity.tolist() == [3.0, 3.0]
    assert np.isnan(chain.jerk[0]) and chain.jerk[1] == 4.0 and np.isnan(chain.effort).all()


@pytest.mark.parametrize(
    "types", ["RPR", "rpr", ["R", "p", "revolute"], [0, 1, 0], np.array([0, 1, 0]), ("r", 1, "R")]
)
def test_types_as_users_write_them(types):
    chain = chain_from_dh([1, 2, 3], [0] * 3, [0] * 3, types=types)
    assert chain.types.tolist() == [0, 1, 0]


def test_a_base_and_a_tool_with_few_digits_are_taken_as_the_nearest():
    turn = np.eye(4)
    turn[:2, :2] = np.round([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]], 5)
    for place in ("base", "tool"):
        chain = chain_from_dh([1], [0], [0], **{place: turn})
        R = forward_kinematics(chain, [0.3])[:3, :3]
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)


def test_dh_chain_names_and_limits():
    limits = {"lower": [-1, 0], "upper": [1, 2], "velocity": [3, 4], "jerk": [5, 6]}
    chain = chain_from_dh([1, 2], [0, 0], [0, 0], types="RP", limits=limits, name="arm")
    assert chain.joint_names == ("joint_1", "joint_2")
    assert chain.links == ("base_link", "link_1", "link_2", "tool0")
    assert (chain.name, chain.types.tolist()) == ("arm", [0, 1])
    assert (chain.upper.tolist(), chain.jerk.tolist()) == ([1, 2], [5, 6])
    assert np.isnan(chain.acceleration).all()
    assert chain_from_dh([1], [0], [0], limits=[[-1, 2]]).upper.tolist() == [2.0]
    assert chain_from_dh([1], [0], [0], types=["prismatic"]).types.tolist() == [1]
    assert chain_from_dh([1], [0], [0]).continuous.all()


@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        (([], [], []), WrongSizeError, "a has size 0, expected at least 1"),
        (([1, 2], [0], [0, 0]), WrongSizeError, "b has size 1, expected 2"),
        (([[1]], [0], [0]), WrongSizeError, r"a has shape \(1, 1\)"),
        (([np.nan], [0], [0]), NonFiniteError, r"a\[0\] is nan"),
        ((["x"], [0], [0]), BadValueError, r"a is \['x'\], expected an array of real"),
        (([1], [0], [0], None, {"types": "X"}), BadValueError, r"joint type is 'X', expected R"),
        (([1], [0], [0], None, {"types": "RR"}), WrongSizeError, "types has size 2"),
        (([1], [0], [0], None, {"tool": np.eye(3)}), WrongSizeError, r"tool has shape \(3, 3\)"),
        (([1], [0], [0], None, {"base": 2 * np.eye(4)}), BadValueError, "last row of base"),
        (([1], [0], [0], None, {"tool": np.diag([1, 2, 1, 1])}), BadValueError, "rotation of tool"),
        (([1], [0], [0], None, {"base": np.full((4, 4), np.nan)}), NonFiniteError, r"base\[0, 0\]"),
        (([1], [0], [0], None, {"limits": [[1, -1]]}), BadValueError, "'joint_1' is .*lower <= up"),
        (([1], [0], [0], None, {"limits": [1, 1]}), WrongSizeError, r"limits has shape \(2,\)"),
        (([1], [0], [0], None, {"limits": {"speed": [1]}}), BadValueError, "'speed', expected one"),
        (
            ([1], [0], [0], None, {"limits": {"velocity": [-1]}}),
            BadValueError,
            "velocity limit of joint",
        ),
        (([1], [0], [0], None, {"limits": {"velocity": [1, 2]}}), WrongSizeError, "limits velocit"),
        (([1], [0], [0], None, {"limits": {"lower": [np.nan]}}), NonFiniteError, "limits lower"),
        (([1], [0], [0], None, {"joint_names": ["a", "b"]}), WrongSizeError, "joint_names has"),
        (([1], [0], [0], None, {"joint_names": "j"}), BadValueError, "a list of 1 name$"),
        (([1e300], [0], [0]), BadValueError, r"a\[0\] is 1e[+]300, expected at most 1e[+]06 m"),
        (
            ([1], [0], [1e300]),
            BadValueError,
            r"alpha\[0\] is 1e[+]300, expected at most 100000 rad",
        ),
        (([1], [0], [0], None, {"types": 5}), BadValueError, "types is 5, expected R"),
        (([1], [0], [0], None, {"types": [True]}), BadValueError, "joint type is True"),
        (
            ([1], [0], [0], None, {"limits": [[-1, 1]] * 2}),
            WrongSizeError,
            r"shape \(1, 2\), or a map",
        ),
        (([1], [0], [0], None, {"limits": [["a", 1]]}), BadValueError, "pairs .lower, upper."),
        (([1], [0], [0], None, {"limits": "x"}), BadValueError, "pairs .lower, upper."),
        (([1], [0], [0], None, {"limits": {"upper": "1"}}), BadValueError, "None is no limit"),
        (([1], [0], [0], None, {"base_link": "tool0"}), BadValueError, "differ from each other"),
        (([1], [0], [0], None, {"tip_link": "link_1"}), BadValueError, "differ from each other"),
        (([1], [0], [0], None, {"base_link": None}), BadValueError, "base_link is None"),
        (([1], [0], [0], None, {"name": 3}), BadValueError, "name is 3, expected a name"),
    ],
)
def test_bad_dh_parameters_are_refused(arguments, error, text):
    *positional, keywords = arguments if isinstance(arguments[-1], dict) else (*arguments, {})
    with pytest.raises(error, match=text):
        chain_from_dh(*positional, **keywords)


def test_a_chain_of_more_joints_than_anything_could_be_found_for_is_refused():
    zeros = np.zeros(65)
    assert chain_from_dh(zeros[1:], zeros[1:], zeros[1:]).n == 64
    text = "number of joints is 65, expected at most 64 in a chain"
    with pytest.raises(BadValueError, match=text):
        chain_from_dh(zeros, zeros, zeros)
    joints = "".join(
        f'<link name="l{k}"/><joint name="j{k}" type="continuous">'
        f'<parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k in range(65)
    )
    with pytest.raises(BadValueError, match=text):
        load_robot(f'<robot name="snake">{joints}<link name="l65"/></robot>')
