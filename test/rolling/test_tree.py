"""The tree of links of a rolling robot: its wheels roll on the ground as the base moves."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.robots import load_description
from robomech_ros.robots.urdf.visuals import read_visuals
from robomech_ros.rolling import list_rolling, load_rolling, rolling_description
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


@pytest.mark.parametrize("base", [None, "mecanum", 3.0])
def test_what_is_no_base_is_refused(base):
    with pytest.raises(BadValueError, match="expected a RollingBase"):
        rolling_description(base)
