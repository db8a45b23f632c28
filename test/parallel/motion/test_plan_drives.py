"""Motions of drives from place to place: all joints follow in one mode, as far as they can."""

import numpy as np
import pytest
from rated import OPTIONS, rated

from robomech_ros.errors import BadValueError, DurationTooShortError, WrongSizeError
from robomech_ros.outcomes import Code
from robomech_ros.parallel import follow_drives, load_parallel, plan_drives

AWAY = {"hexapod": [0.05, 0.1, -0.03, 0.02, 0.08, 0.0], "delta": [0.4, 0.1, -0.2]}


def planned(name, away, **options):
    mechanism = load_parallel(name).mechanism
    home = mechanism.home()
    here = home[mechanism.drive_index]
    points = [here, here + np.array(away)]
    options = {"limits": rated(mechanism), **OPTIONS, **options}
    return mechanism, plan_drives(mechanism, points, home, **options)


def test_a_plan_needs_no_more_than_places_and_a_posture():
    mechanism = load_parallel("delta").mechanism
    home = mechanism.home()
    here = home[mechanism.drive_index]
    plan = plan_drives(mechanism, [here, here + AWAY["delta"]], home)
    assert plan.way.stop is None
    assert np.diff(plan.sampled.waypoints.times).max() <= 0.01 + 1e-12


@pytest.mark.parametrize("name", AWAY)
@pytest.mark.parametrize("profile", ["poly345", "ruckig", "time_optimal"])
def test_all_joints_follow_the_drives(name, profile):
    mechanism, plan = planned(name, AWAY[name], profile=profile)
    points = plan.sampled.waypoints
    assert plan.way.stop is None
    assert plan.way.q.shape == (len(points.times), mechanism.n)
    assert np.abs(plan.way.q[:, mechanism.drive_index] - points.positions).max() < 1e-12
    assert mechanism.loop_errors(plan.way.q).max() < 1e-10
    # One of the poses that a solver without a memory finds is where the platform is.
    poses = load_parallel(name).direct(points.positions[-1]).poses
    last = mechanism.pose(plan.way.q[-1])
    assert np.abs(poses - last).max(axis=(1, 2)).min() < 1e-9


def test_rates_of_passive_joints_are_kept_or_the_duration_refused():
    mechanism = load_parallel("delta").mechanism
    velocity = rated(mechanism).velocity.copy()
    joint = mechanism.joint_names.index("leg2_elbow_tilt")
    velocity[joint] = 0.05
    limits = rated(mechanism, velocity=velocity)
    _, free = planned("delta", AWAY["delta"])
    _, held = planned("delta", AWAY["delta"], limits=limits)
    points = held.sampled.waypoints
    qd, _ = mechanism.rates(held.way.q, points.velocities)
    assert 0.045 < np.abs(qd[:, joint]).max() <= 0.05 * (1.0 + 1e-9)
    assert held.sampled.trajectory.duration > free.sampled.trajectory.duration
    with pytest.raises(DurationTooShortError, match="leg2_elbow_tilt"):
        planned(
            "delta", AWAY["delta"], limits=limits, duration=free.sampled.trajectory.duration + 0.01
        )


def test_a_singularity_on_the_way_stops_before_it_with_the_index():
    mechanism = load_parallel("planar_3rpr").mechanism
    home = mechanism.home()
    here = home[mechanism.drive_index]
    goal = here + [-7.0, 1.0, -6.0]
    plan = plan_drives(mechanism, [here, goal], home, limits=rated(mechanism), **OPTIONS)
    way = plan.way
    assert way.status is Code.SINGULAR
    assert 0 < way.stop == len(way.q) < len(plan.sampled.waypoints.times)
    assert "hardly hold the platform against" in way.reason
    # Before it all is well; after it the mode could only be guessed: no pose continues the way.
    assert mechanism.loop_errors(way.q).max() < 1e-10
    tighter = follow_drives(mechanism, plan.sampled.waypoints.positions, home, condition=50.0)
    assert tighter.stop <= way.stop
    assert "rises over 50" in tighter.reason


def test_a_passive_joint_at_its_limit_stops_the_way():
    mechanism = load_parallel("hexapod").mechanism
    home = mechanism.home()
    way = home[mechanism.drive_index] + np.linspace(0.0, 3.0, 60)[:, None] * [1, 0, 0, 0, 0, 0]
    found = follow_drives(mechanism, way, home)
    assert found.stop is not None
    assert found.status in (Code.LIMIT, Code.SINGULAR)
    assert found.reason


def test_a_joint_at_its_cone_stops_the_way():
    # On this way each of its two axes stays within the angle of the cone, but not both together.
    robot = load_parallel("hexapod")
    mechanism = robot.mechanism
    home = mechanism.home()
    here, goal = home[mechanism.drive_index], [0.948, 0.873, 0.77, 0.748, 0.907, 0.63]
    found = follow_drives(
        mechanism, here + np.linspace(0.0, 1.0, 101)[:, None] * (goal - here), home
    )
    assert found.status is Code.LIMIT and 0 < found.stop < 101
    assert "leaves its limits, by up to 0.133 rad" in found.reason
    assert robot.cone_excess(mechanism.pose(found.q)).max() <= 1e-9


@pytest.mark.parametrize(
    ("change", "kind", "text"),
    [
        ({"points": [[0.0, 0.0, 0.0]]}, WrongSizeError, "points"),
        ({"points": [[0.0] * 4] * 2}, WrongSizeError, "points"),
        ({"start": np.zeros(15)}, BadValueError, "limb"),
        ({"condition": 0.5}, BadValueError, "above 1"),
    ],
)
def test_wrong_requests_say_what_is_wrong(change, kind, text):
    mechanism = load_parallel("delta").mechanism
    start = mechanism.home() + 0.0
    here = start[mechanism.drive_index]
    request = {"points": [here, here + 0.1], "start": start, **change}
    if text == "limb":
        request["start"] = start + np.eye(15)[3] * 0.01
    with pytest.raises(kind, match=text):
        plan_drives(
            mechanism,
            request.pop("points"),
            request.pop("start"),
            limits=rated(mechanism),
            **OPTIONS,
            **request,
        )
