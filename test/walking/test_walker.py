"""A walker: feet that stand still, margins, limits, time-outs and refusals."""

import math
from pathlib import Path

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import RobomechError
from robomech_ros.outcomes import Code
from robomech_ros.walking import GAITS, Walker, load_legged, stability_margin
from robomech_ros.walking.trunk_path import TrunkPath

ROBOTS = {
    "wave": "phantomx",
    "ripple": "phantomx",
    "tripod": "phantomx",
    "crawl": "go1",
    "trot": "go1",
}
# Cycles are longer for a trunk that sways.
SLOWER = {"crawl": 8}
FAST = np.array([0.6, 0.12, 0.12])


def walker_of(gait, **options):
    return Walker(load_legged(ROBOTS[gait]), gait=gait, **options)


def check(walker, last, update, deep):
    """Check the properties that hold in every period."""
    robot = walker.robot
    assert update.margin >= walker.bound - 1e-12
    assert update.contacts.sum() >= (3 if GAITS[walker.gait].static else 2)
    assert (np.abs(update.rates) <= robot.velocity * (1.0 + 1e-9)).all()
    assert (update.q >= robot.lower - 1e-9).all() and (update.q <= robot.upper + 1e-9).all()
    both = update.contacts & last.contacts
    assert np.abs(update.feet[both] - last.feet[both]).max(initial=0.0) <= 1e-9
    if deep:
        seen = robot.feet(update.q) @ update.trunk[:3, :3].T + update.trunk[:3, 3]
        assert np.abs(seen - update.feet).max() <= 1e-9
        centre = update.trunk[:3, :3] @ robot.mass_centre + update.trunk[:3, 3]
        margin = stability_margin(centre[:2], update.feet[update.contacts, :2])
        assert update.margin == pytest.approx(margin, abs=1e-12)


def stroll(gait, periods, seed):
    """Random commands, poses and time-outs."""
    walker, rng = walker_of(gait), np.random.default_rng(seed)
    last, twist, accepted = walker.update(), np.zeros(3), 0
    gone = 0.0
    for k in range(periods):
        if k % 170 == 0:
            twist = FAST * rng.uniform(-1.0, 1.0, 3) * (rng.random() < 0.85)
        if k % 60 == 0 and rng.random() < 0.9:
            walker.command(twist)
        if k % 700 == 350:
            pose = rng.uniform(-1.0, 1.0, 6) * [0.01, 0.01, 0.01, 0.05, 0.05, 0.1]
            accepted += walker.command_pose(pose).status == Code.NONE
        update = walker.update()
        check(walker, last, update, k % 50 == 0)
        gone += float(np.hypot(*(update.base[:2] - last.base[:2])))
        last = update
    assert gone > 0.01
    return walker


@pytest.mark.parametrize("gait", ROBOTS)
def test_margins_limits_and_standing_feet_under_random_commands(gait):
    stroll(gait, 4000, 1)


@pytest.mark.long
@pytest.mark.parametrize("gait", ROBOTS)
def test_ten_minutes_of_random_commands(gait):
    stroll(gait, 120000, 2)


@pytest.mark.parametrize("gait", ROBOTS)
def test_the_trunk_moves_as_commanded_and_legs_stand_as_long_as_the_gait_says(gait):
    slower = SLOWER.get(gait, 1)
    walker = walker_of(gait, timeout=1e9, cycle=2.4 * slower)
    twist = np.array([0.02, 0.004, 0.002]) / slower
    walker.command(twist)
    steps = round(walker.cycle / walker.period)
    for _ in range(3 * steps):
        walker.update()
    contacts = []
    for _ in range(steps):
        update = walker.update()
        assert update.twist == pytest.approx(twist, abs=1e-9) and update.part == 1.0
        contacts.append(update.contacts)
    duty = float(GAITS[gait].duty)
    assert np.abs(np.sum(contacts, axis=0) - duty * steps).max() <= 1.0


def test_the_crawl_sways_about_the_way_that_is_commanded():
    """After each cycle the trunk is where the command alone leads, to 1e-9."""
    walker = walker_of("crawl", timeout=1e9, cycle=7.2)
    twist = walker.fastest * [0.2, 0.5, -0.2]
    walker.command(twist)
    steps = round(walker.cycle / walker.period)
    assert steps * walker.period == pytest.approx(walker.cycle, abs=1e-12)
    updates = [walker.update() for _ in range(5 * steps)][2 * steps :]
    expected = np.eye(4)
    turn, way = twist[0] * walker.cycle, np.array([*twist[1:], 0.0])
    expected[:3, :3] = pinocchio.exp3(np.array([0.0, 0.0, turn]))
    expected[:3, 3] = pinocchio.Jexp3(np.array([0.0, 0.0, -turn])) @ (way * walker.cycle)
    frames = np.tile(np.eye(4), (len(updates), 1, 1))
    frames[:, :2, 3] = [update.base[:2] for update in updates]
    frames[:, :3, :3] = [pinocchio.exp3(np.array([0.0, 0.0, update.base[2]])) for update in updates]
    trunks = np.array([update.trunk for update in updates])
    for begin in range(0, 2 * steps, 97):
        moved = np.linalg.inv(frames[begin]) @ frames[begin + steps]
        assert np.abs(moved - expected).max() < 1e-9
        beside, later = (np.linalg.inv(frames[k]) @ trunks[k] for k in (begin, begin + steps))
        assert np.abs(beside - later).max() < 1e-9
    sway = np.hypot(*(trunks - frames)[:, :2, 3].T)
    assert sway.max() > 0.05


def zero_moment_margins(walker, updates):
    """How far the zero-moment point, by differences, is inside of the standing feet."""
    centre = np.append(walker.robot.mass_centre, 1.0)
    centres = np.array([update.trunk @ centre for update in updates])[:, :3]
    rates = (centres[2:] - 2.0 * centres[1:-1] + centres[:-2]) / walker.period**2
    tilts = centres[1:-1, 2:] / (9.81 + rates[:, 2:])
    points = centres[1:-1, :2] - tilts * rates[:, :2]
    margins = [
        stability_margin(point, update.feet[update.contacts, :2])
        for point, update in zip(points, updates[1:-1], strict=True)
    ]
    return np.array(margins), rates


def test_the_trunk_sways_so_slowly_that_its_acceleration_does_not_tip_the_robot():
    walker = walker_of("crawl", timeout=1e9)
    walker.command(walker.fastest * [0.0, 1.0, 0.0])
    updates = [walker.update() for _ in range(round(2.0 * walker.cycle / walker.period))]
    margins, _ = zero_moment_margins(walker, updates)
    # It does so in the worst pose and with the feet where they are worst, and not with much more.
    assert walker.bound < margins.min() < walker.bound + 2.0 * walker.radius


def farthest(walker, way):
    """Take the farthest pose along a way that is not refused; gives how far it is."""
    for part in np.linspace(1.0, 0.1, 91):
        if walker.command_pose(0.1 * part * np.asarray(way)).status == Code.NONE:
            return 0.1 * part
    raise AssertionError


@pytest.mark.parametrize("angle", np.linspace(0.0, 2.0 * np.pi, 6, endpoint=False))
def test_no_pose_has_the_crawl_tip_the_robot(angle):
    walker = walker_of("crawl", timeout=1e9, period=0.01)
    away = np.array([np.cos(angle), np.sin(angle), 0.0, 0.0, 0.0, 0.0])
    assert farthest(walker, away) >= 0.01
    updates, rng = [], np.random.default_rng(4)
    for k in range(round(2.5 * walker.cycle / walker.period)):
        if k % 37 == 0:
            walker.command(walker.fastest * rng.choice([-2.0, 0.0, 2.0], 3))
        updates.append(walker.update())
    assert zero_moment_margins(walker, updates)[0].min() >= walker.bound


@pytest.mark.parametrize("axis", [1, 2])
@pytest.mark.parametrize("gait", ROBOTS)
def test_a_way_to_a_pose_does_not_tip_the_robot_however_short_it_should_be(gait, axis):
    walker = walker_of(gait)
    way = np.eye(6)[axis] * (1.0, 1.0, -1.0, 1.0, 1.0, 1.0)
    far = farthest(walker_of(gait), way)
    assert walker.command_pose(far * way, 0.01).status == Code.NONE
    updates = [walker.update() for _ in range(600)]
    margins, rates = zero_moment_margins(walker, updates)
    still = updates[0].margin
    assert margins.min() >= still - far - 0.02
    assert np.abs(rates[:, 2]).max() < 0.3 * 9.81
    moved = updates[-1].trunk[:3, 3] - updates[0].trunk[:3, 3]
    assert moved[axis] == pytest.approx(far * way[axis], abs=1e-4)


def test_the_goal_of_many_poses_at_once_is_the_last_which_waits():
    way = TrunkPath(np.zeros(6))
    for k in range(40):
        way = way.to(np.full(6, 0.001 * k), 1.0)
    assert way.waiting
    np.testing.assert_array_equal(way.goal, np.full(6, 0.039))


@pytest.mark.slow
@pytest.mark.parametrize("gait", ["tripod", "crawl", "trot"])
def test_a_stream_of_poses_is_followed_without_a_jerk(gait):
    walker = walker_of(gait)
    goals, updates = [], []
    for k in range(1600):
        if k % 4 == 0:
            goals.append(0.01 * np.sin(2.0 * k * walker.period))
            assert walker.command_pose([0.0, goals[-1], 0.0, 0.0, 0.0, 0.0]).status == Code.NONE
        updates.append(walker.update())
    _, rates = zero_moment_margins(walker, updates)
    aside = np.array([update.trunk[1, 3] for update in updates])
    assert np.ptp(aside) > 0.9 * np.ptp(goals)
    assert np.abs(rates).max() < 0.1
    assert np.abs(np.diff(rates, axis=0)).max() / walker.period < 2.0
    for _ in range(600):
        update = walker.update()
    assert update.trunk[1, 3] == pytest.approx(goals[-1], abs=1e-12)
    assert np.array_equal(walker.update().q, update.q)


def test_a_pose_suits_the_gait_that_waits_and_the_gait_the_pose_under_way():
    """A trot may stand taller than a crawl, whose trunk sways."""
    up = np.eye(6)[2]
    walker = walker_of("trot", timeout=1e9)
    walker.command([0.0, 0.05, 0.0])
    for _ in range(100):
        walker.update()
    far = farthest(walker, up)
    with pytest.raises(RobomechError, match="one that suits the pose"):
        walker.command_gait("crawl")
    assert walker.command_pose(np.zeros(6)).status == Code.NONE
    for _ in range(600):
        walker.update()
    walker.command_gait("crawl")
    assert walker.command_pose(far * up).leg in walker.robot.leg_names


@pytest.mark.parametrize("gait", ROBOTS)
def test_twists_grow_no_faster_than_allowed_and_on_the_ray_of_the_command(gait):
    walker = walker_of(gait)
    twist, last = walker.fastest * [0.3, 2.0, 1.0], np.zeros(3)
    most = np.array([1.0, 0.5, 0.5]) * walker.period
    for _ in range(400):
        walker.command(twist)
        update = walker.update()
        grown = np.abs(update.twist) - np.abs(last)
        assert (grown <= most * (1.0 + 1e-9)).all()
        assert np.abs(np.cross(update.twist, twist)).max() < 1e-12
        last = update.twist


@pytest.mark.parametrize("acceleration", [(1.0, 0.5, 0.5), (20.0, 10.0, 10.0)])
@pytest.mark.parametrize("gait", ROBOTS)
def test_no_twist_jumps_whatever_is_commanded(gait, acceleration):
    """Feet at the border of their circles do not stop the robot from one period to the next."""
    walker = walker_of(gait, acceleration=acceleration, timeout=1e9)
    rng, last = np.random.default_rng(3), walker.update()
    most = np.array(acceleration) * walker.period * (1.0 + 1e-9)
    for k in range(6000):
        if k % 37 == 0:
            walker.command(walker.fastest * rng.choice([-2.0, -0.5, 0.0, 0.5, 2.0], 3))
        update = walker.update()
        check(walker, last, update, k % 50 == 0)
        assert (np.abs(update.twist - last.twist) <= most).all()
        last = update


@pytest.mark.parametrize("gait", ROBOTS)
def test_a_robot_that_was_commanded_too_fast_for_long_stops_as_soon_as_any_other(gait):
    """Motion that it could not follow has not accumulated."""
    walker = walker_of(gait, timeout=0.1)
    for _ in range(2000):
        walker.command([0.0, 10.0, 0.0])
        walker.update()
    braking = walker.fastest[1] / 0.5
    allowed = walker.timeout + braking + 2.5 * walker.cycle
    updates = [walker.update() for _ in range(round(allowed / walker.period))]
    assert updates[0].walking and not updates[-1].walking and updates[-1].contacts.all()
    after = round((walker.timeout + braking) / walker.period) + 2
    assert not any(update.twist.any() for update in updates[after:])


def top_speed(walker, twist):
    """Return the largest part of a joint's speed limit in a settled walk."""
    walker.stand()
    walker.command(twist)
    steps = round(walker.cycle / walker.period)
    updates = [walker.update() for _ in range(6 * steps)][5 * steps :]
    assert min(update.part for update in updates) > 1.0 - 1e-9
    return max((np.abs(update.rates) / walker.robot.velocity).max() for update in updates)


@pytest.mark.parametrize("gait", ROBOTS)
def test_the_cycle_suits_the_speed_of_the_joints(gait):
    """Joints come up to 60 % of their limits at the longest stride, or something else is faster.

    That is the shortest swing, or a trunk that sways.
    """
    walker = walker_of(gait, timeout=1e9, period=0.01)
    angles = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    ahead = np.stack([np.zeros(8), np.cos(angles), np.sin(angles)], axis=1)
    reached = max(top_speed(walker, twist) for twist in walker.fastest * ahead)
    turning = top_speed(walker, walker.fastest * [1.0, 0.0, 0.0])
    assert max(reached, turning) <= 0.6 * 1.005
    swing = walker.cycle * (1.0 - float(GAITS[gait].duty))
    assert swing >= 0.3 - 1e-12
    assert reached >= 0.6 * 0.98 or swing == pytest.approx(0.3) or GAITS[gait].sways


def test_the_cycle_suits_the_part_of_the_speed_that_is_used():
    assert walker_of("tripod", speed=0.6).cycle == pytest.approx(walker_of("tripod").cycle)
    assert walker_of("tripod", speed=0.4).cycle == pytest.approx(1.5 * walker_of("tripod").cycle)


def test_the_table_of_cycles_in_the_documentation_is_what_walkers_have():
    text = (Path(__file__).parents[2] / "doc" / "walking.md").read_text(encoding="utf-8")
    for gait, robot in ROBOTS.items():
        walker = walker_of(gait)
        swing = walker.cycle * (1.0 - float(GAITS[gait].duty))
        figures = (walker.cycle, swing, walker.fastest[1], walker.fastest[0])
        row = " | ".join(f"{one:.3g}" for one in figures)
        assert f"| {robot} | {gait} | {row} |" in text


def test_a_cycle_that_is_given_stays():
    assert walker_of("wave", cycle=1.2).cycle == 1.2
    walker = walker_of("tripod")
    own = walker.cycle
    walker.command_gait("wave")
    walker.update()
    assert walker.gait == "wave" and walker.cycle > own
    with pytest.raises(RobomechError, match="cycle of the gait 'wave' is 0.1"):
        walker_of("wave", cycle=0.1)


def test_a_cycle_in_which_the_sway_may_tip_the_robot_is_refused():
    least = math.ceil(1e3 * walker_of("crawl").cycle) / 1e3
    assert walker_of("crawl", cycle=least).cycle == least
    why = f"expected {least:g} s or more: a trunk that sways faster may tip the robot"
    with pytest.raises(RobomechError, match=f"cycle of the gait 'crawl' is 5.0, {why}"):
        walker_of("crawl", cycle=5.0)
    walker = walker_of("trot", cycle=1.0)
    with pytest.raises(RobomechError, match=f"cycle of the gait 'crawl' is 1.0, {why}"):
        walker.command_gait("crawl")


def settled_walk(gait, cycle, speed):
    """Return the updates of a walk straight ahead, but for its first cycles."""
    slower = SLOWER.get(gait, 1)
    walker = walker_of(gait, timeout=1e9, cycle=cycle * slower)
    walker.command([0.0, speed / slower, 0.0])
    for _ in range(600 * slower):
        walker.update()
    return [walker.update() for _ in range(1300 * slower)], walker


# The last one is no whole number of periods; rounding decides in which period the others land.
CYCLES = [1.2, 1.17, 0.93, 1.177]


@pytest.mark.parametrize("cycle", CYCLES)
@pytest.mark.parametrize("gait", ROBOTS)
def test_joint_rates_stay_continuous_when_feet_land(gait, cycle):
    updates, walker = settled_walk(gait, cycle, 0.1)
    change = np.abs(np.diff([update.rates for update in updates], axis=0)) / walker.period
    assert change.max() < 2.0 * np.percentile(change, 99.0)


@pytest.mark.parametrize("cycle", CYCLES)
@pytest.mark.parametrize("gait", ROBOTS)
def test_feet_land_where_their_swing_ends(gait, cycle):
    speed = 0.02
    updates, walker = settled_walk(gait, cycle, speed)
    feet = np.array([update.feet for update in updates])
    contacts = np.array([update.contacts for update in updates])
    moved = np.hypot(*np.diff(feet[:, :, :2], axis=0).transpose(2, 0, 1))
    landing = contacts[1:] & ~contacts[:-1]
    # A swing of fifth order is at most 15/8 times as fast as its mean, and goes no further in its
    # last part e than 10 e^3 of its way.
    part = walker.period / ((1.0 - float(GAITS[gait].duty)) * walker.cycle)
    way = speed * cycle
    assert moved.max() <= 15.0 / 8.0 * way * part * 1.001
    assert moved[landing].max() <= 10.0 * part**3 * way
    for k in range(feet.shape[1]):
        places = feet[1:, k][landing[:, k]]
        assert len(places) >= 3
        assert np.diff(places[:, 0]) == pytest.approx(way, abs=1e-9)


@pytest.mark.parametrize("gait", ROBOTS)
def test_a_time_out_ends_with_all_feet_down(gait):
    walker = walker_of(gait)
    walker.command([0.1, 0.02, 0.01])
    last = walker.update()
    for k in range(4000):
        update = walker.update()
        check(walker, last, update, k % 100 == 0)
        last = update
    assert not update.walking and update.contacts.all() and not update.twist.any()
    assert np.array_equal(walker.update().q, update.q)


def test_the_margin_is_kept_through_changes_of_the_gait():
    walker = walker_of("tripod", timeout=1e9)
    walker.command([0.2, 0.05, 0.0])
    last, seen = walker.update(), set()
    for k in range(6000):
        if k % 1000 == 500:
            walker.command_gait(("ripple", "wave", "tripod")[k // 1000 % 3])
        update = walker.update()
        check(walker, last, update, k % 50 == 0)
        last = update
        seen.add(walker.gait)
    assert seen == {"tripod", "ripple", "wave"} and update.walking
    with pytest.raises(RobomechError, match="number of legs for the gait 'trot'"):
        walker.command_gait("trot")


@pytest.mark.parametrize("gait", ROBOTS)
def test_poses_on_planted_feet_close_every_leg(gait):
    walker = walker_of(gait)
    feet = walker.update().feet.copy()
    assert walker.command_pose([0.002, -0.002, 0.004, 0.01, 0.01, 0.02]).status == Code.NONE
    for _ in range(400):
        update = walker.update()
        seen = walker.robot.feet(update.q) @ update.trunk[:3, :3].T + update.trunk[:3, 3]
        assert np.abs(seen - feet).max() <= 1e-9
    height = -walker.robot.feet(walker.robot.home)[:, 2].mean()
    assert update.trunk[:3, 3] == pytest.approx([0.002, -0.002, height + 0.004], abs=1e-12)


@pytest.mark.parametrize("gait", ["tripod", "crawl"])
def test_poses_that_overstretch_or_tip_are_refused_by_leg_and_joint(gait):
    walker = walker_of(gait)
    before = walker.update()
    high = walker.command_pose([0.0, 0.0, 0.5, 0.0, 0.0, 0.0])
    assert high.status in (Code.OUT_OF_REACH, Code.LIMIT)
    assert high.leg in walker.robot.leg_names and high.joint in walker.robot.joint_names
    assert high.leg in high.reason and high.joint in high.reason
    aside = walker.command_pose([0.0, 0.2, 0.0, 0.0, 0.0, 0.0])
    assert aside.status == Code.BAD_VALUE and aside.leg in aside.reason
    for _ in range(50):
        assert np.array_equal(walker.update().q, before.q)


def test_wrong_requests_say_so_and_move_nothing():
    walker = walker_of("tripod")
    robot = walker.robot
    cases = [
        (lambda: walker.command([np.nan, 0.0, 0.0]), "twist"),
        (lambda: walker.command([0.0, 0.0]), "twist"),
        (lambda: walker.command_pose([0.0] * 5), "pose"),
        (lambda: walker.command_pose([0.0] * 6, duration=0.0), "duration"),
        (lambda: walker.command_gait("gallop"), "one of wave"),
        (lambda: Walker(robot, period=0.0), "period"),
        (lambda: Walker(robot, bound=1.0), "margin of the gait"),
        (lambda: Walker(robot, acceleration=[1.0, 0.0, 1.0]), "acceleration"),
        (lambda: Walker("robot"), "a LeggedRobot"),
    ]
    for call, text in cases:
        with pytest.raises(RobomechError) as caught:
            call()
        assert text in str(caught.value)
    assert not walker.update().walking
