"""A gripper that one value moves: widths against Pinocchio, and what is refused."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes" / "motion"))

from gripper_cases import panda_with_hand, poses_by_pinocchio

from robomech_ros.errors import BadValueError, UnknownJointError
from robomech_ros.robots import load_description
from robomech_ros.robots.gripper import gripper_model

FINGERS = ("panda_finger_joint1", "panda_finger_joint2")


def gripper_of(urdf, **options):
    description = load_description(urdf)
    return gripper_model(description, description.chain(tip="panda_hand_tcp"), **options)


@pytest.fixture
def gripper():
    return gripper_of(panda_with_hand())


@pytest.mark.parametrize("width", [0.0, 0.03, 0.08])
def test_the_width_is_the_distance_between_the_fingers(gripper, width):
    (position,) = gripper.positions(width).values()
    poses = poses_by_pinocchio(panda_with_hand(), dict.fromkeys(FINGERS, position))
    left, right = (poses[link][:3, 3] for link in ("panda_leftfinger", "panda_rightfinger"))
    assert np.linalg.norm(left - right) == pytest.approx(width, abs=1e-12)
    assert gripper.value({FINGERS[0]: position}) == pytest.approx(width, abs=1e-12)
    assert (gripper.limits, gripper.unit) == ((0.0, pytest.approx(0.08)), "m")


def test_two_slides_without_mimic_move_together():
    urdf = panda_with_hand().replace('<mimic joint="panda_finger_joint1"/>', "")
    assert gripper_of(urdf).positions(0.05) == dict.fromkeys(FINGERS, pytest.approx(0.025))


def test_without_two_fingers_the_value_is_the_position_of_the_joint():
    one = gripper_of(panda_with_hand(), links=("panda_hand", "panda_hand"))
    assert one.opening is None and one.limits == (0.0, 0.04) and one.unit == "m"
    assert one.positions(0.03) == {FINGERS[0]: 0.03}
    with pytest.raises(BadValueError, match=r"joint 'panda_finger_joint1' is 0.05, .* 0 to 0.04 m"):
        one.positions(0.05)


def test_what_cannot_be_is_refused(gripper):
    for width in (-0.01, 0.081, float("nan")):
        with pytest.raises(BadValueError, match=r"width is .*, expected 0 to 0.08 m"):
            gripper.positions(width)
    with pytest.raises(UnknownJointError):
        gripper_of(panda_with_hand(), name="thumb")


def test_an_arm_without_fingers_has_no_gripper():
    description = load_description("panda")
    assert gripper_model(description, description.chain()) is None
