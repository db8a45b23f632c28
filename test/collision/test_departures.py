"""Motions out of a contact, and blends: what is proved is what is sent."""

import numpy as np
import pytest
from shaped_arm import shaped_ur5e

from robomech_ros.cartesian import PathStopLimits, plan_along
from robomech_ros.collision import Box, PlanningScene, Sphere, check_departure, stop_before_contact
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.joints.joint_limits import with_assumed_rates
from robomech_ros.outcomes import Code
from robomech_ros.robots import load_description
from robomech_ros.spatial import pose_from_matrix
from robomech_ros.trajectory import (
    blended_polyline,
    constant_orientation,
    interpolant,
    pose_path,
    straight_path,
)

HERE = np.array([0.6, -1.2, 1.6, -1.9, -1.5708, 0.0])


@pytest.fixture
def scene():
    """A wall that the arm reaches when its first joint turns by about 0.36 rad."""
    scene, pose = PlanningScene(load_description(shaped_ur5e()).chain()), np.eye(4)
    pose[:3, 3] = 0.55, 0.0, 0.4
    scene.add("wall", Box(0.6, 0.02, 0.8), pose)
    return scene


def turned(*angles):
    """Return a motion of the first joint from angle to angle, a second each."""
    q = np.repeat(HERE[None], len(angles), axis=0)
    q[:, 0] = angles
    return interpolant(np.arange(float(len(angles))), q)


def test_a_contact_is_left_and_what_follows_is_proved(scene):
    out = check_departure(scene, turned(0.1, 0.6))
    assert out.free and not out.certified
    assert check_departure(scene, turned(0.5, 0.6)).certified
    # Out, and back into it.
    back = check_departure(scene, turned(0.1, 0.6, 0.1))
    assert not back.free and 1.0 < back.parameter < 2.0 and "wall" in back.bodies
    assert scene.clearance(turned(0.1, 0.6, 0.1).sample(back.parameter).position).distance < 1e-3


@pytest.mark.parametrize("angles", [(0.1, 0.0), (0.1, 0.0, 0.6), (0.1, 0.0985, 0.6), (0.1, 0.11)])
def test_a_contact_is_not_deepened_and_not_kept(scene, angles):
    found = check_departure(scene, turned(*angles))
    assert not found.free and found.least <= 0.0 and "wall" in found.bodies


@pytest.mark.parametrize("t", [0.0, 0.3, 1.0, 1.7, 2.9])
def test_the_rest_of_a_curve_is_the_curve(t):
    random = np.random.default_rng(0)
    curve = interpolant([0.0, 1.0, 2.5, 3.0], *random.normal(size=(3, 4, 2)))
    rest, times = curve.after(t), np.linspace(t, 3.0, 40)
    assert rest.breaks[0] == pytest.approx(t) and rest.breaks[-1] == 3.0
    for name in ("position", "velocity", "acceleration"):
        ours, theirs = getattr(rest.sample(times), name), getattr(curve.sample(times), name)
        np.testing.assert_allclose(ours, theirs, atol=1e-10)


@pytest.mark.parametrize("blend", ["circular", "parabolic", "quintic"])
def test_a_blend_is_proved_as_it_is_sent(scene, blend):
    """A ball that the tool passes on the sharp corner, and would touch on the blended one."""
    T = forward_kinematics(scene.chain, HERE)
    points = T[:3, 3] + np.array([[0.0, 0.0, 0.0], [-0.3, 0.0, 0.0], [-0.3, 0.2, 0.0]])
    place = forward_kinematics(scene.chain, HERE) @ pose_from_matrix(np.eye(3), [0, 0, -0.03])
    place[:3, 3] += points[1] - T[:3, 3] + np.array([0.05, 0.05, 0.0])
    scene.add("ball", Sphere(0.005), place)
    turned = constant_orientation(T[:3, :3])
    bounds = PathStopLimits(checks=(stop_before_contact(scene),))
    sharp = [pose_from_matrix(T[:3, :3], point) for point in points]
    limits = with_assumed_rates(scene.chain.description)[0].chain()
    whole = plan_along(scene.chain, straight_path(sharp), HERE, bounds=bounds, limits=limits)
    assert whole.stop is None and scene.check_motion(whole.samples).certified
    curve = blended_polyline(points, deviation=0.05, blend=blend)
    path = pose_path(curve, turned)
    unchecked = plan_along(scene.chain, path, HERE, limits=limits)
    assert unchecked.stop is None and not scene.check_motion(unchecked.samples).free
    plan = plan_along(scene.chain, path, HERE, bounds=bounds, limits=limits)
    assert plan.stop.kind.code == Code.COLLISION and 0.2 < plan.fraction < 0.8
    assert "'wrist_3_link' and 'ball' would touch" in plan.stop.text
    assert scene.check_motion(plan.samples).certified
    assert 0.0 < scene.clearance(plan.samples.positions[-1]).distance < 2e-3


def test_wrong_departures_are_named(scene):
    with pytest.raises(BadValueError, match="scene is None, expected a PlanningScene"):
        check_departure(None, turned(0.1, 0.6))
    with pytest.raises(BadValueError, match="motion is .* expected a PiecewisePolynomial"):
        check_departure(scene, [HERE, HERE])
    with pytest.raises(BadValueError, match=r"travel of the joints .* expected at most 1000"):
        check_departure(scene, turned(0.1, 1e5))
