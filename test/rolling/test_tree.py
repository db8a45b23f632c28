"""The tree of links of a rolling robot: its wheels roll on the ground as the base moves."""

from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros.errors import BadValueError
from robomech_ros.robots import load_description
from robomech_ros.robots.urdf.visuals import read_visuals
from robomech_ros.rolling import (
    RollingBase,
    Wheel,
    WheelJoints,
    list_rolling,
    load_rolling,
    rolling_description,
    tricycle,
)
from robomech_ros.rolling.tree import BASE_JOINTS

STEP = 1e-6


def contact_velocities(base, tree, twist, steering, brackets):
    """Velocities of the wheels' points on the ground, in the axes of each wheel (forward, left)."""
    rates = dict(zip(base.names, base.rolling_rates(twist, steering, brackets), strict=True))
    turning = base.caster_rates(twist, brackets) if base.casters else []
    rates |= {f"{n}_bracket": rate for n, rate in zip(base.casters, turning, strict=True)}
    omega, v_x, v_y = twist
    at = dict.fromkeys(BASE_JOINTS, 0.0)
    at |= {f"{n}_steering": a for n, a in zip(base.steered, steering, strict=True)}
    at |= {f"{n}_bracket": a for n, a in zip(base.casters, brackets, strict=True)}
    at["base_heading"] = 0.7
    c, s = np.cos(0.7), np.sin(0.7)
    rates |= {"base_x": c * v_x - s * v_y, "base_y": s * v_x + c * v_y, "base_heading": omega}
    now = tree.link_poses(at)
    ends = [
        tree.link_poses(
            {n: at.get(n, 0.0) + sign * STEP * rates.get(n, 0.0) for n in {*at, *rates}}
        )
        for sign in (1.0, -1.0)
    ]
    found = []
    for name, radius in zip(base.names, base.radii, strict=True):
        T = now[f"{name}_link"]
        point = np.linalg.solve(T, T[:, 3] - [0.0, 0.0, radius, 0.0])
        moved = (ends[0][f"{name}_link"] - ends[1][f"{name}_link"]) @ point / (2.0 * STEP)
        found.append(moved[:3] @ T[:3, :2])
    return np.array(found)


@pytest.mark.parametrize("name", list_rolling())
def test_wheels_roll_without_slipping_where_the_joints_say(name):
    base = load_rolling(name)
    tree = rolling_description(base)
    rng = np.random.default_rng(5)
    for _ in range(5):
        twist = base.feasible(rng.uniform(-0.4, 0.4, 3) + [0.0, 1.0, 0.0])
        steering = base.steering_angles(twist)
        brackets = rng.uniform(-1.0, 1.0, len(base.casters))
        slips = contact_velocities(base, tree, twist, steering, brackets)
        for wheel, (forward, left) in zip(base.wheels, slips, strict=True):
            # Rollers let it slip across their axes; along them it holds.
            along = np.cos(wheel.roller) * forward + np.sin(wheel.roller) * left
            assert along == pytest.approx(0.0, abs=1e-8)
            if wheel.kind != "omni":
                assert left == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("name", ["mecanum", "omni"])
def test_rollers_are_drawn_along_their_axes(name):
    base = load_rolling(name)
    visuals = read_visuals(rolling_description(base).document, "here")
    for wheel_name, wheel in zip(base.names, base.wheels, strict=True):
        own = [one.pose for one in visuals if one.link == f"{wheel_name}_link"]
        lowest = min(own, key=lambda pose: pose[2, 3])
        axis = [np.cos(wheel.roller), np.sin(wheel.roller), 0.0]
        np.testing.assert_allclose(lowest[:3, 2], axis, atol=1e-9)


@pytest.mark.parametrize("name", list_rolling())
def test_the_text_of_the_tree_is_a_urdf(name):
    tree = rolling_description(load_rolling(name))
    again = load_description(tree.document)
    assert [joint.name for joint in again.joints] == [joint.name for joint in tree.joints]
    assert tree.root == "odom"


def turn(axis, angle):
    return Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix()


def wheel_pose(wheel, pivot, roll):
    """Return the pose of a wheel in the base, derived from the meaning of its arguments alone."""
    R = turn(2, wheel.heading + pivot)
    T = np.eye(4)
    T[:3, :3] = R @ turn(1, roll)
    T[:2, 3] = wheel.position - wheel.trail * R[:2, 0]
    T[2, 3] = wheel.radius
    return T


# Wheels that look anywhere, with rollers of all angles.
ODD = RollingBase(
    [
        Wheel(kind="omni", position=(0.3, 0.2), radius=0.1, heading=0.4, roller=0.3),
        Wheel(kind="steered", position=(-0.3, 0.25), radius=0.07, heading=-1.9, name="s"),
        Wheel(
            kind="steered",
            position=(-0.3, -0.4),
            radius=0.2,
            heading=2.2,
            steering_limits=(-1.5, 2.0),
        ),
        Wheel(kind="caster", position=(0.2, -0.2), radius=0.03, trail=0.02, heading=1.0, name="c"),
    ],
    name="odd",
)


@pytest.mark.parametrize("base", [*map(load_rolling, list_rolling()), ODD], ids=lambda b: b.name)
def test_from_the_base_on_every_wheel_is_where_its_joints_put_it(base):
    tree = rolling_description(base, base_link="hub", placed=False)
    joints = WheelJoints.of(base)
    assert tree.root == "hub" and set(tree.joint_names) == set(joints.names)
    rng = np.random.default_rng(3)
    for _ in range(20):
        at = dict(zip(joints.names, rng.uniform(-9.0, 9.0, len(joints.names)), strict=True))
        poses = tree.link_poses(at)
        placed = rolling_description(base).link_poses({**at, "base_x": 1.0, "base_heading": 0.3})
        for name, wheel in zip(base.names, base.wheels, strict=True):
            pivot = at.get(f"{name}_steering", at.get(f"{name}_bracket", 0.0))
            expected = wheel_pose(wheel, pivot, at[name])
            np.testing.assert_allclose(poses[f"{name}_link"], expected, atol=1e-12)
            # Where it is placed, the same tree begins at the base.
            seen = np.linalg.solve(placed["base_link"], placed[f"{name}_link"])
            np.testing.assert_allclose(seen, expected, atol=1e-12)


def test_links_have_names_of_their_own():
    wheels = [
        Wheel(kind="fixed", position=(0.0, 0.2), radius=0.1, name="base"),
        Wheel(kind="fixed", position=(0.0, -0.2), radius=0.1, name='a<&"'),
        Wheel(kind="caster", position=(0.3, 0.0), radius=0.05, trail=0.02, name="odom"),
    ]
    base = RollingBase(wheels)
    tree = rolling_description(base, placed=False)
    assert tree.links == ("base_link", "base_link_", 'a<&"_link', "odom_holder", "odom_link")
    for link in ("base_link_", "odom_holder"):
        again = rolling_description(base, base_link=link)
        assert again.link_poses({"base": 0.3}).keys() == set(again.links)
        assert len(again.links) == 8 and link in again.links


def test_several_joints_of_one_wheel_stand_in_a_row_and_one_without_is_fixed():
    base = tricycle(radius=0.1, wheelbase=0.8, track=0.5)
    front, left, right = (base.names.index(name) for name in ("front", "rear_left", "rear_right"))
    joints = WheelJoints((("a", left), ("b", left), ("c", left), ("d", right)), ("turn",))
    tree = rolling_description(base, joints, placed=False)
    assert set(tree.joint_names) == {"a", "b", "c", "d", "turn"}
    poses = tree.link_poses({"a": 0.1, "b": 0.2, "c": 0.3, "turn": 0.4})
    for name, roll, ahead in (("a", 0.1, 0.22), ("b", 0.2, 0.0), ("c", 0.3, -0.22)):
        expected = wheel_pose(base.wheels[left], 0.0, roll)
        expected[0, 3] += ahead
        np.testing.assert_allclose(poses[f"{name}_link"], expected, atol=1e-12)
    expected = wheel_pose(base.wheels[front], 0.4, 0.0)
    np.testing.assert_allclose(poses["front_link"], expected, atol=1e-12)
    # The plate covers all of them.
    (plate, *_) = (one for one in read_visuals(tree.document) if one.link == "base_link")
    assert plate.pose[0, 3] - 0.5 * plate.measures[0] < -0.22


@pytest.mark.parametrize("name", list_rolling())
def test_colours_have_names(name):
    """RViz gives all unnamed colours of a link that of the first."""
    root = ElementTree.fromstring(rolling_description(load_rolling(name)).document)
    named = {}
    for material in root.iter("material"):
        named.setdefault(material.get("name"), set()).add(material.find("color").get("rgba"))
    assert "" not in named and None not in named
    assert all(len(colours) == 1 for colours in named.values()) and len(named) >= 4


@pytest.mark.parametrize("base", [None, "mecanum", 3.0])
def test_what_is_no_base_is_refused(base):
    with pytest.raises(BadValueError, match="expected a RollingBase"):
        rolling_description(base)
