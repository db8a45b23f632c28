"""Errors: their texts, their fields, and that they travel between processes."""

import pickle
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from robomech_ros import errors
from robomech_ros.errors.formatting import counted

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "doc" / "extensions"))

from public_names import public_packages  # noqa: E402

CASES = [
    (
        errors.UnknownRobotError("pum", ["puma560", "ur5e"]),
        "unknown robot 'pum' (did you mean 'puma560'?); available: puma560, ur5e",
    ),
    (errors.UnknownLinkError("x", []), "unknown link 'x'; available: none"),
    (errors.UnknownJointError("j9", ["joint_1"]), "unknown joint 'j9'; available: joint_1"),
    (errors.WrongSizeError("q", 5, 6), "q has size 5, expected 6"),
    (errors.WrongSizeError("q", (5,), "(6,)"), "q has shape (5,), expected (6,)"),
    (errors.NonFiniteError("angle", float("nan")), "angle is nan, expected finite numbers"),
    (
        errors.NonFiniteError("q", np.array([[0.0, np.inf]])),
        "q[0, 1] is inf, expected finite numbers",
    ),
    (errors.BadQuaternionError([0, 0, 0, 0], "all zero"), "quaternion [0, 0, 0, 0]: all zero"),
    (errors.BadValueError("mode", 7, "0 or 1"), "mode is 7, expected 0 or 1"),
    (errors.MissingLimitsError("jerk", ["a", "b"]), "no jerk limit for joints a, b"),
    (errors.RobotDescriptionError("arm.urdf: line 3", "no link"), "arm.urdf: line 3: no link"),
    (
        errors.SeedOutsideLimitsError("j", 2.0, -1.0, 1.5),
        "seed of joint 'j' is 2, outside its limits [-1, 1.5] by 0.5",
    ),
    (
        errors.SeedOutsideLimitsError("j", 2.0, -1.0, 1.5, "start", unit="m"),
        "start of joint 'j' is 2 m, outside its limits [-1, 1.5] by 0.5 m",
    ),
    (
        errors.LimitExceededError("velocity", "j", -3.0, -2.0),
        "velocity of joint 'j' is -3, over its limit -2 by 1",
    ),
    (
        errors.LimitExceededError("velocity", "j", -3.0, -2.0, "rad/s"),
        "velocity of joint 'j' is -3 rad/s, over its limit -2 rad/s by 1 rad/s",
    ),
    (
        errors.LoopClosureError("q[2]", 3, 0.0123456, 0.2),
        "q[2] has open loops: limb 3 ends 0.0123 m and 0.2 rad from where limb 1 holds the "
        "platform, expected closed loops",
    ),
    (
        errors.SingularPostureError("posture", [0.0] * 36, "one in which the drives hold it"),
        "posture is singular, expected one in which the drives hold it",
    ),
    (
        errors.MissingSupportError(["LF", "RF"], [0.0, 1.5, 0.0, 0.0, 0.0, 2.0], " at 0.1 s"),
        "feet LF, RF cannot carry the load at 0.1 s within friction cones and effort limits: a "
        "moment [0, 1.5, 0] N m and a force [0, 0, 2] N on the trunk are missing; put more feet on "
        "the ground, or accelerate less",
    ),
    (errors.MapFileError("map.npz", "damaged"), "map.npz: damaged"),
    (
        errors.NotEnoughMemoryError("a map of 9 cells", 24_000_000, 5),
        "a map of 9 cells takes 24,000,000 bytes of memory, of which 5 bytes are available",
    ),
]


@pytest.mark.parametrize(("error", "text"), CASES)
def test_texts_and_pickles(error, text):
    assert str(error) == text
    assert isinstance(error, errors.RobomechError)
    assert isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == text
    assert str(vars(again)) == str(vars(error))


def test_every_error_of_a_public_package_is_exported():
    """Errors that callers may have to catch can be imported and are documented."""
    exported = set().union(*public_packages().values())
    hidden = []
    for package in {name.split(".")[1] for name in public_packages()}:
        for path in (ROOT / "robomech_ros" / package).rglob("*.py"):
            # Those that are no RobomechError are caught inside.
            classes = re.findall(r"^class ([A-Z]\w*Error)\((?!Exception)", path.read_text(), re.M)
            hidden += [f"{path}: {name}" for name in classes if name not in exported]
    assert {"AddressError", "DaskUnavailableError", "LostPostureError"} <= exported
    assert hidden == []


def test_only_one_has_no_plural():
    assert [counted(k, "leg") for k in range(3)] == ["0 legs", "1 leg", "2 legs"]


def test_long_values_and_lists_are_cut():
    assert len(str(errors.BadValueError("x", "y" * 10_000, "less"))) < 300
    text = str(errors.UnknownJointError("j", [f"joint_{i}" for i in range(1000)]))
    assert text.endswith("and 960 more")


class _WithoutRepresentation:
    def method(self):
        """Be bound."""


@pytest.mark.parametrize(
    "value",
    [
        _WithoutRepresentation(),
        [_WithoutRepresentation(), object()],
        {"key": _WithoutRepresentation()},
        lambda x: x,
        _WithoutRepresentation().method,
        map(len, []),
    ],
)
def test_no_error_shows_an_address(value):
    for error in (errors.BadValueError("x", value, "a number"), errors.NonFiniteError("x", value)):
        assert " at 0x" not in str(error)
        assert "<" in str(error)


def test_an_object_without_a_representation_is_shown_by_its_type():
    text = str(errors.BadValueError("chain", _WithoutRepresentation(), "a chain"))
    assert text == f"chain is <{__name__}._WithoutRepresentation>, expected a chain"


@pytest.mark.parametrize("number", [np.float64(1e14), np.int64(7), np.bool_(True), np.array(2.5)])
def test_numbers_of_numpy_are_shown_as_numbers(number):
    assert "np." not in errors.format_value(number) and "array" not in errors.format_value(number)
    assert errors.format_value(number) == repr(number.item())
