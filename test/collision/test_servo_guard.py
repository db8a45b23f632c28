"""A servo among objects: it stops before contact, leaves contact, and is slowed by nothing else."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from arms import random_pose, random_postures, six_joints
from second_opinion import SecondOpinion
from shaped_arm import shaped_ur5e

sys.path.insert(0, str(Path(__file__).parents[1] / "servo"))
from servo_drives import TIMEOUT, Drive

from robomech_ros.collision import Box, Plane, PlanningScene, Sphere
from robomech_ros.collision.robot_bodies import link_shapes
from robomech_ros.collision.servo_guard import ServoGuard
from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.joints.joint_limits import with_assumed_rates
from robomech_ros.robots import load_description
from robomech_ros.servo.commands import PoseCommand
from robomech_ros.servo.contact_slowing import ContactAhead, MotionAhead, slowed
from robomech_ros.servo.report import ServoCondition

ARMS = {"ur5e": shaped_ur5e, "six": six_joints}
KEPT = 1e-3
HERE = np.array([0.6, -1.2, 1.6, -1.9, -1.5708, 0.0])
BEFORE_CONTACT = (ServoCondition.APPROACHING_CONTACT, ServoCondition.CONTACT)
AT_FULL_SPEED = (ServoCondition.NO_WARNING, ServoCondition.RATE_BOUND)


@pytest.fixture(scope="module", params=ARMS)
def scene(request):
    chain = with_assumed_rates(load_description(ARMS[request.param]()))[0].chain()
    return PlanningScene(chain, padding=KEPT)


@pytest.fixture(scope="module")
def ur5e():
    chain = with_assumed_rates(load_description(shaped_ur5e()))[0].chain()
    return PlanningScene(chain, padding=KEPT)


def drive_in(scene, q, guarded=True):
    drive = Drive("ur5e", q, chain=scene.chain)
    drive.servo.guard = ServoGuard(scene) if guarded else None
    return drive


def jog(drive, world, random):
    """Command something for a while; joints go where something is near."""
    size, seconds = 10 ** random.uniform(-0.7, 0.3), random.uniform(0.3, 0.6)
    kind = random.integers(3)
    if kind == 0:
        ways = random.uniform(-1.0, 1.0, (8, drive.chain.n))
        nearest = np.argmin(world.clearance(drive.q + 0.2 * ways).distance)
        return drive.joints(size * ways[nearest], seconds)
    if kind == 1:
        return drive.twist(size * random.normal(size=6) * np.repeat((0.5, 0.3), 3), seconds)
    T = forward_kinematics(drive.chain, drive.q)
    T[:3, 3] += random.uniform(-0.4, 0.4, 3)
    return drive._again(lambda: PoseCommand(T, 0.4, 0.8, drive.time + TIMEOUT), seconds)


def among_boxes(scene, random):
    """Return a world of boxes and a floor, and a free posture in it."""
    while True:
        world = scene.copy()
        world.add("floor", Plane([0, 0, 1], -0.3))
        for k in range(16):
            world.add(f"box_{k}", Box(*random.uniform(0.05, 0.3, 3)), random_pose(random, 0.8))
        free = [q for q in random_postures(scene.chain, random, 10) if world.is_free(q)]
        if free:
            return world, free[0]


def test_random_jogs_touch_nothing_and_leave_room_to_brake(scene):
    random, slowed = np.random.default_rng(5), 0
    for _ in range(5):
        world, q = among_boxes(scene, random)
        drive = drive_in(world, q)
        for _ in range(3):
            jog(drive, world, random)
        slowed += any(report.condition in BEFORE_CONTACT for report in drive.reports)
        drive.assert_limits()
        judge = SecondOpinion(world, link_shapes(scene.chain.description)[0])
        # The places it passed, and those where it would have stopped from each.
        stops = [plan.positions[-1] for plan in drive.plans]
        for q in [*drive.path()[::8], *stops[::2]]:
            distance, bodies = judge.clearance(q)
            # Links keep their distance from objects, and do not touch each other.
            kept = KEPT if any(name in world.objects for name in bodies) else 0.0
            assert distance > kept - 1e-6, (bodies, q)
    assert slowed > 1


def test_half_of_the_braking_suffices_to_stop_before_contact():
    guard = SimpleNamespace(contact=lambda curve: ContactAhead(0.6, 1.0, 0.1, ""))
    ahead = MotionAhead(np.array([[0.0], [1.0]]), seconds=0.5, stop=2.0, limited=1.0)
    part = slowed(guard, ahead).part
    # With half the braking a part p of the speed takes a way of p^2 stop, in s at full speed.
    assert part**2 * ahead.stop == pytest.approx(0.6 * ahead.seconds, rel=0.01)


def contacts(scene, random, count):
    """Return postures in contact with a ball around their last link, with the scene of each."""
    found = []
    for q in random_postures(scene.chain, random, 50):
        if len(found) == count or not scene.is_free(q):
            continue
        world, place = scene.copy(), forward_kinematics(scene.chain, q)
        place[:3, 3] += 0.1 * random.normal(size=3)
        world.add("ball", Sphere(0.1), place)
        if world.clearance(q).distance < -0.005:
            found.append((q, world))
    assert len(found) == count
    return found


def test_every_contact_can_be_left_and_none_is_deepened(scene):
    random = np.random.default_rng(2)
    for q, world in contacts(scene, random, 10):
        steps = np.vstack((np.eye(scene.chain.n), random.normal(size=(20, scene.chain.n))))
        before = world.clearance(q).distance
        after = world.clearance(q + 1e-3 * steps / np.abs(steps).max(axis=1)[:, None]).distance
        out, into = steps[np.argmax(after)], steps[np.argmin(after)]
        for way, leaves in ((out, True), (into, False)):
            drive = drive_in(world, q)
            reports = drive.joints(0.3 * way / np.abs(way).max(), 0.3)
            if leaves:
                moved = world.clearance(drive.q).distance - before
                assert moved > 1e-3 and max(report.scale for report in reports) > 0.9
            else:
                assert reports[-1].condition is ServoCondition.CONTACT
                assert "ball" in reports[-1].text and "m deep" in reports[-1].text
                np.testing.assert_array_equal(drive.q, q)


@pytest.mark.parametrize(
    "twist", [(0, 0, 0, 0, -0.15, 0), (0, 0, 0, 0.1, 0, 0.05), (0, 0, 0, 0, 0.15, 0)]
)
def test_motion_along_a_wall_and_away_from_it_is_not_slowed(ur5e, twist):
    world = ur5e.copy()
    world.add("wall", Plane([0, -1, 0], -forward_kinematics(ur5e.chain, HERE)[1, 3] - 0.25))
    drive = drive_in(world, HERE)
    halted = drive.twist([0, 0, 0, 0, 0.2, 0], 3.0)[-1]
    assert halted.condition is ServoCondition.CONTACT and "'wall'" in halted.text
    assert 0.0 < world.clearance(drive.q).distance < 2e-3
    free = drive_in(world, drive.q, guarded=False)
    stood, count = drive.q, len(drive.positions)
    reports = drive.twist(twist, 1.0)
    if twist[4] > 0.0:
        np.testing.assert_allclose(drive.q, stood, atol=1e-3)
        return
    free.twist(twist, 1.0)
    assert {report.condition for report in reports} <= set(AT_FULL_SPEED)
    np.testing.assert_allclose(drive.path()[count:], free.path()[1:], atol=1e-9)


def test_who_moves_slowly_arrives_soon(ur5e):
    """The proximity slows fast motion down, and does not let slow motion creep."""
    world, times = ur5e.copy(), []
    world.add("wall", Plane([0, -1, 0], -forward_kinematics(ur5e.chain, HERE)[1, 3] - 0.1))
    for speed in (0.02, 0.2):
        drive = drive_in(world, HERE)
        reports = drive.twist([0, 0, 0, 0, speed, 0], 6.0)
        kinds = [report.condition for report in reports]
        assert ServoCondition.APPROACHING_CONTACT in kinds
        times.append(kinds.index(ServoCondition.CONTACT) * drive.period)
    way = 0.1 - 0.04
    assert times[0] < way / 0.02 + 1.5 and times[1] < way / 0.2 + 1.5


def test_wrong_guards_and_curves_are_refused(ur5e):
    """A curve that is not finite is no free one."""
    for wrong, text in (
        ((None,), "scene"),
        ((ur5e, -1.0), "self_proximity"),
        ((ur5e, 0.0, np.nan), "scene_proximity"),
    ):
        with pytest.raises(RobomechError, match=text):
            ServoGuard(*wrong)
    guard = ServoGuard(ur5e)
    for curve in (np.full((2, 6), np.nan), np.zeros((1, 6)), np.zeros((2, 5)), HERE, None):
        with pytest.raises(RobomechError, match="curve"):
            guard.contact(curve)
        with pytest.raises(RobomechError, match="curves"):
            guard.obstruction(None if curve is None else curve[None])
    with pytest.raises(RobomechError, match="curves"):
        guard.obstruction(np.empty((0, 2, 6)))
