"""The black-box checks of walking machines on what goes to the controller, for every gait."""

import numpy as np
import pytest

from robomech_ros.nodes.walker.stream import WalkStream, rising
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.walking import GAITS, Walker, load_legged, stability_margin

ROBOTS = {
    "wave": "phantomx",
    "ripple": "phantomx",
    "tripod": "phantomx",
    "crawl": "go1",
    "trot": "go1",
}
PERIOD = 0.01


def stream_of(gait, **options):
    walker = Walker(load_legged(ROBOTS[gait]), gait=gait, period=PERIOD, speed=0.95, **options)
    stream = WalkStream(walker, 0.2)
    stream.begin(0.0)
    return stream


def time_to_stop(stream):
    """Return how often to go on: feet go back to their places within two cycles of the gait."""
    return 100 + round(2.0 * stream.walker.cycle / 0.02)


def cycles(stream, count, twist=None, begin=0):
    """Go on, 50 times a second, with a command in each; give the present knots."""
    knots = []
    for k in range(begin, begin + count):
        if twist is not None:
            stream.walker.command(twist)
        stream.go_on(0.02 * k)
        knots.append((stream.present, stream.samples()))
    return knots


@pytest.mark.parametrize("gait", ROBOTS)
def test_standing_feet_stay_where_they_are_and_margins_and_limits_hold(gait):
    stream = stream_of(gait)
    robot, bound = stream.walker.robot, stream.walker.bound
    knots = cycles(stream, 300, [0.1, 0.02, 0.01])
    knots += cycles(stream, time_to_stop(stream), begin=300)
    told = {}
    last = None
    for knot, samples in knots:
        curve = interpolant(samples.times, samples.positions, samples.velocities)
        times = np.linspace(samples.times[0], samples.times[-1], 200)
        rates = np.array([curve.sample(time).velocity for time in times])
        assert (np.abs(rates) <= robot.velocity * (1.0 + 1e-9)).all()
        for time, q in zip(samples.times[:-1], samples.positions[:-1], strict=True):
            assert (q >= robot.lower).all() and (q <= robot.upper).all()
            told[round((knot.time + time) / PERIOD)] = q
        update = knot.update
        # What the joints were told puts the feet where they are said to be.
        q = told.get(round(knot.time / PERIOD), update.q)
        feet = robot.feet(q) @ update.trunk[:3, :3].T + update.trunk[:3, 3]
        assert np.abs(feet - update.feet).max() <= 1e-9
        assert update.contacts.sum() >= (3 if GAITS[gait].static else 2)
        centre = update.trunk[:3, :3] @ robot.mass_centre + update.trunk[:3, 3]
        margin = stability_margin(centre[:2], update.feet[update.contacts, :2])
        assert margin == pytest.approx(update.margin, abs=1e-12) and margin >= bound - 1e-12
        if last is not None:
            both = update.contacts & last.contacts
            assert np.abs(update.feet[both] - last.feet[both]).max(initial=0.0) <= 1e-9
        last = update
    # The time-out has ended it with all feet down.
    assert last.contacts.all() and not last.walking and not stream.moves
    assert np.hypot(*last.base[:2]) > 0.01


@pytest.mark.parametrize("gait", ROBOTS)
def test_a_robot_that_stopped_anywhere_goes_on_from_there(gait):
    stream = stream_of(gait)
    knots = cycles(stream, 150, [0.1, 0.02, 0.01])
    stopped = knots[-20][0].update
    assert stream.resume(10.0, stopped.q + 0.01)
    stream.go_on(10.0)
    assert np.abs(stream.present.update.q - stopped.q).max() < 0.02
    # The joints have time to get there.
    assert stream.samples().times[0] >= 0.2 and stream.moves
    for k in range(time_to_stop(stream)):
        stream.go_on(10.0 + 0.02 * k)
        assert stream.present.update.margin >= stream.walker.bound - 1e-12
    assert stream.present.update.contacts.all() and not stream.present.update.walking
    assert not stream.resume(20.0, stopped.q + 1.0)


def test_a_process_that_was_held_up_goes_on_from_where_the_joints_braked():
    stream = stream_of("tripod")
    cycles(stream, 100, [0.0, 0.03, 0.0])
    ahead = stream._knots[-1].update
    stream.go_on(7.0)
    assert np.array_equal(stream.present.update.q, ahead.q)
    for k in range(time_to_stop(stream)):
        stream.go_on(7.0 + 0.02 * k)
    assert stream.present.update.contacts.all() and not stream.present.update.walking


def test_a_pose_is_reached_over_feet_that_stand_still():
    stream = stream_of("tripod")
    feet = stream.present.update.feet
    assert stream.walker.command_pose([0.0, 0.0, 0.01, 0.0, 0.0, 0.05]).status == Code.NONE
    knots = cycles(stream, 100)
    for knot, _ in knots:
        assert np.abs(knot.update.feet - feet).max() == 0.0
    assert np.abs(knots[-1][0].update.trunk[2, 3] - knots[0][0].update.trunk[2, 3]) > 0.009


def test_a_rise_keeps_its_part_of_the_limits():
    walker = Walker(load_legged("phantomx"))
    robot = walker.robot
    way = rising(walker, robot.home + 0.5, 0.2)
    assert way.times[0] == pytest.approx(1.5 * 0.5 / (0.2 * 6.18))
    assert np.array_equal(way.positions[0], robot.home) and not way.velocities.any()
