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
    ],
)
def test_an_inconsistent_chain_cannot_be_made(changes, error, text):
    with pytest.raises(error, match=text):
        two_joints(**changes)


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
    ],
)
def test_bad_dh_parameters_are_refused(arguments, error, text):
    *positional, keywords = arguments if isinstance(arguments[-1], dict) else (*arguments, {})
    with pytest.raises(error, match=text):
        chain_from_dh(*positional, **keywords)
