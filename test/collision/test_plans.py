"""Plans around obstacles: every kind of goal and of arm, each path looked at by Pinocchio, too."""

import math

import numpy as np
import pytest
from arms import COUPLED, joint, link, six_joints, sliding, without_self_contact
from second_opinion import SecondOpinion

from robomech_ros.collision import (
    Box,
    Capsule,
    Cylinder,
    Plane,
    PlanningScene,
    PlanStatus,
    Sphere,
    motion_proof,
    path_through,
    planning,
    timed_path,
)
from robomech_ros.collision.libraries import PLANNERS
from robomech_ros.collision.path_timing import NotFreeError
from robomech_ros.collision.robot_bodies import link_shapes
from robomech_ros.errors import (
    BadValueError,
    DurationTooShortError,
    NonFiniteError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.trajectory import Limits

# Both sides of a wall that stands in front of the arm.
LEFT = np.array([0.9, 1.3, 0.3, 0.0, 0.4, 0.0])
RIGHT = np.array([-0.9, 1.3, 0.3, 0.0, 0.4, 0.0])


def at(x, y, z):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def with_wall(height=0.9):
    scene = PlanningScene(six_joints())
    scene.add("wall", Box(0.8, 0.05, height), at(0.7, 0.0, 0.5 * height))
    return scene


def looked_at(scene, plan, others=None):
    """Look at a path every 2 mrad or 2 mm."""
    judge = SecondOpinion(scene, link_shapes(scene.chain.description)[0], others)
    for a, b in zip(plan.waypoints[:-1], plan.waypoints[1:], strict=True):
        count = math.ceil(np.abs(b - a).max() / 2e-3) + 1
        rows = np.linspace(a, b, count + 1)
        assert judge.first_hit(rows) is None
        assert (rows >= scene.chain.lower - 1e-9).all() and (rows <= scene.chain.upper + 1e-9).all()


def solved(scene, start, goals, **options):
    """Plan, and check all that a plan says."""
    plan = scene.plan(start, goals, timeout=30.0, **options)
    assert plan.status is PlanStatus.SOLVED, plan.reason
    assert plan.certified and plan.reason == ""
    np.testing.assert_array_equal(plan.waypoints[0], start)
    assert scene.check_motion(
        plan.waypoints, **{key: value for key, value in options.items() if key == "clearance"}
    ).certified
    looked_at(scene, plan)
    return plan


def test_around_a_wall():
    scene = with_wall()
    assert scene.is_free(LEFT) and scene.is_free(RIGHT)
    assert not scene.check_motion([LEFT, RIGHT]).free
    plan = solved(scene, LEFT, RIGHT)
    np.testing.assert_array_equal(plan.waypoints[-1], RIGHT)
    assert plan.goal == 0 and len(plan.waypoints) > 2
    again = scene.plan(LEFT, RIGHT)
    np.testing.assert_array_equal(plan.waypoints, again.waypoints)
    other = solved(scene, LEFT, RIGHT, seed=5)
    assert (
        other.waypoints.shape != plan.waypoints.shape or (other.waypoints != plan.waypoints).any()
    )


def test_what_only_looks_free_is_gone_around(monkeypatch):
    """Motions that are hardly looked at before their proof."""
    monkeypatch.setattr(motion_proof, "_STEP", 1.0)
    monkeypatch.setattr(motion_proof, "_LOOK", 1.0)
    scene, failed = PlanningScene(six_joints()), []
    scene.add("plate", Box(0.8, 0.001, 0.9), at(0.7, 0.0, 0.45))
    proves = planning._Search._proves

    def counted(search, motion):
        proved = proves(search, motion)
        failed.append(not proved)
        return proved

    monkeypatch.setattr(planning._Search, "_proves", counted)
    solved(scene, LEFT, RIGHT)
    assert any(failed)


@pytest.mark.parametrize("seed", range(6))
def test_waypoints_in_a_closed_room_are_left_out(monkeypatch, seed):
    """Motions that are hardly looked at lead into a room that has no door."""
    monkeypatch.setattr(motion_proof, "_STEP", 3.0)
    monkeypatch.setattr(motion_proof, "_LOOK", 3.0)
    parts = [link(name) for name in ("base", "a", "b")] + [
        link("tool", (Sphere(0.02), (0, 0, 0), 0)),
        joint("x", "base", "a", "0 0 0", "1 0 0", "prismatic", (-2, 2)),
        joint("y", "a", "b", "0 0 0", "0 1 0", "prismatic", (-2, 2)),
        joint("z", "b", "tool", "0 0 0", "0 0 1", "prismatic", (-2, 2)),
    ]
    scene = PlanningScene(f'<robot name="ball">{"".join(parts)}</robot>')
    for k in range(3):
        sizes = np.full(3, 2.4)
        sizes[k] = 0.001
        for side in (-1.2, 1.2):
            scene.add(f"plate {k} {side}", Box(*sizes), at(*(side * np.eye(3)[k])))
    scene.add("block", Box(1.6, 1.6, 1.6))
    plan = scene.plan([-1.5, 0.1, 0.0], [1.5, 0.0, 0.1], seed=seed, timeout=3.0)
    assert plan.status is PlanStatus.SOLVED and plan.certified, plan.reason


def test_straight_where_nothing_is_in_between():
    scene = PlanningScene(six_joints())
    plan = solved(scene, LEFT, RIGHT)
    assert len(plan.waypoints) == 2
    here = solved(scene, LEFT, LEFT)
    assert len(here.waypoints) == 2 or len(here.waypoints) == 1


def test_the_clearance_is_kept():
    scene = with_wall()
    plan = solved(scene, LEFT, RIGHT, clearance=0.03)
    for a, b in zip(plan.waypoints[:-1], plan.waypoints[1:], strict=True):
        assert scene.is_free(np.linspace(a, b, 100), clearance=0.03).all()


@pytest.mark.parametrize("planner", PLANNERS)
def test_each_planner_of_ompl(planner):
    plan = with_wall(0.7).plan(
        LEFT, RIGHT, planner=planner, timeout=20.0 if "FMT" in planner else 1.0
    )
    assert plan.status is PlanStatus.SOLVED and plan.certified


def test_joints_without_limits_turn_no_farther_than_can_be_proved():
    scene = PlanningScene(sliding(), base="rail", tip="palm")
    far, turn = np.zeros(4), scene.chain.joint_names.index("turn")
    far[turn] = 1e12
    for start, goal in ((far, far), (np.zeros(4), far)):
        with pytest.raises(BadValueError, match="of joint 'turn' is 1000000000000.0, expected at"):
            path_through(scene, [start, goal])


def test_one_of_several_postures_is_enough():
    scene = with_wall()
    inside = np.array([0.0, 1.3, 0.3, 0.0, 0.4, 0.0])
    assert not scene.is_free(inside)
    plan = solved(scene, LEFT, [inside, RIGHT])
    assert plan.goal == 1
    np.testing.assert_array_equal(plan.waypoints[-1], RIGHT)
    near = LEFT + 0.05
    assert solved(scene, LEFT, [inside, RIGHT, near]).goal == 2


def test_all_postures_of_a_pose_are_goals():
    scene = with_wall()
    pose = forward_kinematics(scene.chain, RIGHT)
    plan = solved(scene, LEFT, pose)
    np.testing.assert_allclose(forward_kinematics(scene.chain, plan.waypoints[-1]), pose, atol=1e-6)
    postures = inverse_kinematics(scene.chain, pose, seed=LEFT).q
    assert len(postures) > 1
    np.testing.assert_allclose(postures[plan.goal], plan.waypoints[-1], atol=1e-9)
    # That posture is taken away by an object: another one is found.
    blocked = scene.copy()
    blocked.add(
        "block", Sphere(0.04), blocked.link_pose("fore", plan.waypoints[-1]) @ at(0, 0, 0.1)
    )
    if any(blocked.is_free(postures)):
        other = solved(blocked, LEFT, pose)
        assert other.goal != plan.goal


def test_a_pose_out_of_reach():
    plan = PlanningScene(six_joints()).plan(LEFT, at(3.0, 0.0, 0.0))
    assert plan.status is PlanStatus.NO_POSTURE and plan.goal == -1 and not plan.certified
    assert plan.waypoints.shape == (0, 6) and plan.reason


def test_goals_in_contact_are_named():
    scene = with_wall()
    inside = np.array([0.0, 1.3, 0.3, 0.0, 0.4, 0.0])
    depth = -scene.clearance(inside).distance
    plan = scene.plan(LEFT, inside)
    assert plan.status is PlanStatus.GOAL_IN_CONTACT and not len(plan.waypoints)
    assert "the goal is in contact" in plan.reason and "'wall'" in plan.reason
    assert f"{depth:.3g} m deep" in plan.reason
    plan = scene.plan(LEFT, [inside, inside + 0.01])
    assert "all 2 goals are in contact" in plan.reason
    plan = scene.plan(LEFT, forward_kinematics(scene.chain, inside))
    assert plan.status is PlanStatus.GOAL_IN_CONTACT
    near = scene.plan(LEFT, RIGHT, clearance=0.5)
    assert near.status is PlanStatus.GOAL_IN_CONTACT and "m apart" in near.reason
    assert near.reason.startswith("the goal is nearer to a body than the clearance of 0.5 m: ")
    with pytest.raises(WrongSizeError, match="goals has shape"):
        scene.plan(LEFT, np.zeros((2, 2, 6)))


def test_a_start_nearer_than_the_clearance_is_left_first():
    scene = table()
    scene.add("ball", Sphere(0.1))
    plan = scene.plan([-0.2, 0.0], [-1.0, 0.0], clearance=0.1)
    assert plan.status is PlanStatus.SOLVED and not plan.certified
    text = "the start is nearer to a body than the clearance of 0.1 m and is left first: "
    assert plan.reason.startswith(text) and "0.05 m apart" in plan.reason


def test_a_start_in_contact_is_left_while_the_distance_grows():
    scene = without_self_contact(PlanningScene(six_joints()))
    start = np.array([0.0, 1.3, 0.3, 0.0, 0.4, 0.0])
    tip = forward_kinematics(scene.chain, start)[:3, 3]
    scene.add("block", Box(0.3, 0.3, 0.1), at(*(tip - [0.0, 0.0, 0.02])))
    assert not scene.is_free(start)
    plan = scene.plan(start, RIGHT, timeout=20.0)
    assert plan.status is PlanStatus.SOLVED and not plan.certified
    assert "the start is in contact and is left first" in plan.reason and "'block'" in plan.reason
    np.testing.assert_array_equal(plan.waypoints[0], start)
    np.testing.assert_array_equal(plan.waypoints[-1], RIGHT)
    distances = scene.clearance(plan.waypoints).distance
    out = int(np.argmax(distances > 0.0))
    assert out > 0 and (np.diff(distances[: out + 1]) > 0.0).all()
    assert scene.check_motion(plan.waypoints[out:]).certified
    again = scene.plan(start, RIGHT, timeout=20.0)
    np.testing.assert_array_equal(plan.waypoints, again.waypoints)
    limits = Limits(scene.chain.joint_names, **LIMITS)
    seconds = 2.0 * timed_path(scene, plan.waypoints, limits).trajectory.duration
    timed = timed_path(scene, plan.waypoints, limits, duration=seconds)
    assert timed.verification.ok
    assert timed.waypoints.times[-1] == pytest.approx(seconds, abs=3e-9)
    rows, speeds = timed.waypoints.positions, np.abs(timed.waypoints.velocities).max(axis=1)
    stop = int(np.argmin(np.abs(rows - plan.waypoints[out]).max(axis=1)))
    assert speeds[[0, stop, -1]].max() < 1e-9
    np.testing.assert_allclose(rows[[0, stop, -1]], plan.waypoints[[0, out, -1]], atol=1e-9)
    assert scene.check_motion(rows[stop:]).certified


def test_a_start_that_cannot_be_left():
    scene = PlanningScene(six_joints())
    scene.add("cast", Box(0.5, 0.5, 0.5), at(0.0, 0.0, 0.3))
    plan = scene.plan(LEFT, RIGHT, timeout=2.0)
    assert plan.status in (PlanStatus.START_IN_CONTACT, PlanStatus.GOAL_IN_CONTACT)
    assert "'cast'" in plan.reason and "m deep" in plan.reason


def test_a_carried_object_in_contact_at_the_start_is_to_be_named_in_touch_links():
    scene = PlanningScene(six_joints())
    scene.add("box", Box(0.05, 0.05, 0.05))
    scene.attach("box", "hand", pose=at(0.0, 0.0, -0.06))
    assert set(scene.clearance(LEFT).bodies) == {"box", "bend"}
    plan = scene.plan(LEFT, RIGHT)
    assert plan.status in (PlanStatus.GOAL_IN_CONTACT, PlanStatus.START_IN_CONTACT)
    assert "'box'" in plan.reason and "'bend'" in plan.reason
    scene.attach("box", "hand", ["bend", "wrist", "fore"], pose=at(0.0, 0.0, -0.06))
    assert scene.plan(LEFT, RIGHT).certified


def table():
    """Return a scene of two slides that carry a ball."""
    parts = [
        link("base"),
        link("bridge"),
        link("tool", (Sphere(0.05), (0, 0, 0), 0)),
        joint("x", "base", "bridge", "0 0 0", "1 0 0", "prismatic", (-2, 2)),
        joint("y", "bridge", "tool", "0 0 0", "0 1 0", "prismatic", (-2, 2)),
    ]
    return PlanningScene(f'<robot name="table">{"".join(parts)}</robot>')


def test_no_path_in_time_is_said():
    scene = table()
    scene.add("wall", Box(0.01, 5.0, 1.0))
    plan = scene.plan([-1.0, 0.0], [1.0, 0.0], timeout=0.3)
    assert plan.status is PlanStatus.NO_PATH and plan.goal == -1 and not len(plan.waypoints)
    assert not plan.certified
    assert "no path within 0.3 s" in plan.reason and "nearest posture reached is" in plan.reason
    assert plan.seconds >= 0.3
    # A tree grows from the goal, too, but the wall is between.
    nearest = plan.reason.split("[")[1].split("]")[0].split(",")
    assert float(nearest[0]) < 0.0


def test_the_only_gap_is_far_from_start_and_goal():
    scene = table()
    scene.add("wall", Box(0.01, 4.2, 1.0), at(0.0, -0.4, 0.0))
    start, goal = np.array([[-0.2, -1.5], [0.2, -1.5]])
    plan = solved(scene, start, goal)
    assert plan.waypoints[:, 1].max() > 1.75


def arm_of(count):
    """Return the URDF of an arm of so many joints, alternately about z and y."""
    axes = ["0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0", "0 1 0"]
    parts, last = [link("base", (Cylinder(0.06, 0.1), (0, 0, 0.05), 0))], "base"
    for k in range(count):
        length = 0.3 if k in (1, 2) else 0.12
        shape = (Capsule(0.03, length - 0.1), (0, 0, 0.5 * length), 0)
        parts.append(link(f"link_{k}", shape))
        away = "0 0 0.15" if k == 0 else f"0 0 {0.3 if k in (2, 3) else 0.12}"
        parts.append(joint(f"joint_{k}", last, f"link_{k}", away, axes[k], limits=(-2.6, 2.6)))
        last = f"link_{k}"
    parts += ['<link name="tool"/>', joint("end", last, "tool", "0 0 0.12", kind="fixed")]
    return f'<robot name="arm">{"".join(parts)}</robot>'


@pytest.mark.parametrize("count", [4, 5, 7])
def test_arms_of_four_five_and_seven_joints(count):
    scene = PlanningScene(arm_of(count))
    assert scene.chain.n == count
    scene.add("post", Cylinder(0.05, 1.2), at(0.45, 0.0, 0.6))
    start, goal = np.full(count, 0.1), np.full(count, 0.1)
    start[:3], goal[:3] = (0.6, 1.2, 0.2), (-0.6, 1.2, 0.2)
    assert not scene.check_motion([start, goal]).free
    solved(scene, start, goal)
    pose = forward_kinematics(scene.chain, goal)
    plan = solved(scene, start, pose)
    np.testing.assert_allclose(forward_kinematics(scene.chain, plan.waypoints[-1]), pose, atol=1e-5)
    # Four postures of an arm of four joints are (4, 4), too.
    rows = np.tile(goal, (4, 1))
    assert solved(scene, start, rows).status is PlanStatus.SOLVED


def palletizer():
    """Return the URDF of the palletizer with shapes."""
    text = (COUPLED / "palletizer.urdf").read_text(encoding="utf-8")
    shapes = {
        "lower_arm": (Box(0.03, 0.03, 0.1), (0, 0, 0.07), 0),
        "upper_arm": (Box(0.12, 0.03, 0.03), (0.075, 0, 0), 0),
        "hand": (Box(0.03, 0.05, 0.02), (0.06, 0, -0.02), 0),
        "tool0": (Cylinder(0.015, 0.03), (0, 0, 0), 0),
    }
    for name, shape in shapes.items():
        text = text.replace(f'<link name="{name}"/>', link(name, shape))
    return text


def test_joints_that_follow_others():
    scene = PlanningScene(palletizer())
    assert scene.chain.n == 4
    scene.add("wall", Box(0.2, 0.01, 0.25), at(0.25, 0.0, 0.125))
    start, goal = np.array([0.8, 0.5, 0.3, 0.0]), np.array([-0.8, 0.5, 0.3, 0.0])
    assert not scene.check_motion([start, goal]).free
    solved(scene, start, goal)
    pose = forward_kinematics(scene.chain, goal)
    plan = solved(scene, start, pose)
    np.testing.assert_allclose(forward_kinematics(scene.chain, plan.waypoints[-1]), pose, atol=1e-6)


def test_joints_without_limits_turn_the_short_way():
    scene = without_self_contact(PlanningScene(sliding(), base="rail", tip="palm"))
    start, goal = np.array([0.0, 2.6, 0.0, 0.0]), np.array([0.1, -2.6, 0.0, 0.0])
    plan = solved(scene, start, goal)
    assert len(plan.waypoints) == 2
    assert plan.waypoints[-1, 1] == pytest.approx(2 * np.pi - 2.6)
    scene.add("post", Cylinder(0.03, 1.0), at(-0.6, 0.0, 0.3))
    found = scene.plan(start, goal, timeout=20.0)
    assert found.certified
    end = found.waypoints[-1]
    assert math.remainder(end[1] - goal[1], 2 * np.pi) == pytest.approx(0.0, abs=1e-9)
    looked_at(scene, found)


def test_other_users_of_ompl_keep_random_numbers_of_their_own():
    random, scene = planning.ompl().util.RNG, with_wall()
    first, *others = (scene.plan(LEFT, RIGHT).waypoints for _ in range(3))
    assert all((first == other).all() for other in others)

    def numbers_after_plans():
        found = []
        for _ in range(2):
            scene.plan(LEFT, RIGHT)
            found.append(random().uniform01())
        return found

    # They differ from plan to plan, and are the same again for a seed of the user's own.
    random.setSeed(7)
    found = numbers_after_plans()
    assert found[0] != found[1]
    random.setSeed(7)
    assert numbers_after_plans() == found


def test_limits_that_were_rounded():
    scene = with_wall()
    upper = scene.chain.upper
    start = LEFT.copy()
    start[5] = upper[5] + 3e-6
    found = scene.plan(start, RIGHT)
    assert found.certified
    assert found.waypoints[0][5] == upper[5]
    with pytest.raises(SeedOutsideLimitsError, match="start"):
        scene.plan(start + [0, 0, 0, 0, 0, 2e-5], RIGHT)


def test_wrong_requests():
    scene = with_wall()
    for start in (LEFT[:5], np.zeros((2, 6))):
        with pytest.raises(WrongSizeError):
            scene.plan(start, RIGHT)
    with pytest.raises(NonFiniteError):
        scene.plan(LEFT, [math.nan] * 6)
    for goals in (np.zeros(5), np.zeros((2, 7))):
        with pytest.raises(WrongSizeError):
            scene.plan(LEFT, goals)
    with pytest.raises(SeedOutsideLimitsError, match="start"):
        scene.plan(LEFT + 9.0, RIGHT)
    with pytest.raises(SeedOutsideLimitsError, match="goal"):
        scene.plan(LEFT, RIGHT - 9.0)
    for options, name in (
        ({"timeout": 0.0}, "timeout"),
        ({"timeout": math.nan}, "timeout"),
        ({"seed": -1}, "seed"),
        ({"seed": 0.5}, "seed"),
        ({"planner": "Dijkstra"}, "planner"),
        ({"clearance": -1}, "clearance"),
    ):
        with pytest.raises((BadValueError, NonFiniteError), match=name):
            scene.plan(LEFT, RIGHT, **options)
    empty = scene.plan(LEFT, np.empty((0, 6)))
    assert empty.status is PlanStatus.NO_POSTURE and "no goal" in empty.reason


LIMITS = {"velocity": 1.5, "acceleration": 4.0, "jerk": 40.0}


@pytest.mark.parametrize("profile", ["time_optimal", "double_s", "ruckig", "poly345"])
def test_timed_paths_are_within_limits_and_proved(profile):
    scene = with_wall()
    limits = Limits(scene.chain.joint_names, **LIMITS)
    plan = scene.plan(LEFT, RIGHT)
    timed = timed_path(scene, plan.waypoints, limits, profile=profile)
    assert scene.check_motion(timed.waypoints).certified and timed.verification.ok
    t = np.linspace(0.0, timed.waypoints.times[-1], 3000)
    q, v, a = timed.waypoints.curve.sample(t)[:3]
    judge = SecondOpinion(scene, link_shapes(scene.chain.description)[0])
    assert judge.first_hit(q) is None
    np.testing.assert_allclose(q[[0, -1]], [LEFT, RIGHT], atol=1e-9)
    assert np.abs(v).max() <= 1.5 + 1e-6 and np.abs(a).max() <= 4.0 + 1e-6
    assert np.abs(v[[0, -1]]).max() < 1e-9


VIA = np.array(
    [LEFT, LEFT + [-0.2, -0.4, 0.2, 0.0, 0.3, 0.0], RIGHT + [0.2, -0.4, 0, 0, 0, 0], RIGHT]
)


@pytest.mark.parametrize("profile", ["time_optimal", "ruckig", "cubic_spline", "poly345"])
def test_paths_pass_via_points_and_last_as_long_as_wanted(profile):
    scene = with_wall()
    assert not scene.check_motion(VIA).free
    plan = path_through(scene, VIA)
    assert plan.status is PlanStatus.SOLVED and plan.certified
    looked_at(scene, plan)
    limits = Limits(scene.chain.joint_names, **LIMITS)
    shortest = timed_path(scene, plan.waypoints, limits, profile=profile).trajectory
    timed = timed_path(
        scene, plan.waypoints, limits, profile=profile, duration=1.7 * shortest.duration
    )
    assert timed.verification.ok and scene.check_motion(timed.waypoints).certified
    assert timed.waypoints.times[-1] == pytest.approx(1.7 * shortest.duration, abs=2e-9)
    t = np.linspace(0.0, timed.waypoints.times[-1], 20_000)
    rows = timed.waypoints.curve.sample(t)[0]
    assert SecondOpinion(scene, link_shapes(scene.chain.description)[0]).first_hit(rows) is None
    assert max(np.abs(rows - point).max(axis=1).min() for point in VIA) < 2e-4
    # The robot stops at via points only if the profile takes no more of them.
    speeds = np.abs(timed.waypoints.velocities).max(axis=1)
    assert (np.count_nonzero(speeds < 1e-9) > 2) == (profile == "poly345")
    with pytest.raises(DurationTooShortError, match=f"{shortest.duration:.9g}"):
        timed_path(
            scene, plan.waypoints, limits, profile=profile, duration=0.99 * shortest.duration
        )


def test_paths_through_points_keep_turns_and_name_the_leg():
    scene = with_wall()
    within = VIA.copy()
    within[2, 0] = 0.0
    plan = path_through(scene, within)
    assert plan.status is PlanStatus.GOAL_IN_CONTACT and not len(plan.waypoints)
    assert plan.reason.startswith("from point 2 to point 3 of 4: the goal is in contact: ")
    assert "'wall'" in plan.reason
    with pytest.raises(BadValueError, match="at least two"):
        path_through(scene, LEFT)
    turning = without_self_contact(PlanningScene(sliding(), tip="palm"))
    points = np.zeros((3, turning.chain.n))
    points[1:, turning.chain.joint_names.index("turn")] = 4.0, 8.0
    np.testing.assert_array_equal(path_through(turning, points).waypoints, points)


def test_paths_that_leave_no_room_for_a_curve_are_timed_with_stops():
    """A slot with square corners, in the space of two slides, hardly wider than the tool."""
    scene = table()
    gap = 0.0502
    scene.add("below", Box(3.0, 1.0, 0.2), at(0.5, -gap - 0.5, 0.0))
    scene.add("right", Box(1.0, 3.0, 0.2), at(1.0 + gap + 0.5, 0.5, 0.0))
    scene.add("corner", Box(2.0, 2.0, 0.2), at(1.0 - gap - 1.0, gap + 1.0, 0.0))
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    assert scene.check_motion(path).certified
    timed = timed_path(scene, path, Limits(scene.chain.joint_names, **LIMITS))
    assert scene.check_motion(timed.waypoints).certified
    speeds = np.abs(timed.waypoints.velocities).max(axis=1)
    corner = np.argmin(np.linalg.norm(timed.waypoints.positions - [1.0, 0.0], axis=1))
    assert speeds[corner] < 0.2 and speeds[[0, -1]].max() < 1e-12


def test_what_cannot_be_timed():
    scene = with_wall()
    limits = Limits(scene.chain.joint_names, **LIMITS)
    with pytest.raises(NotFreeError, match="in contact at waypoint 0.*'wall'"):
        timed_path(scene, [LEFT, RIGHT], limits)
    with pytest.raises(BadValueError, match="at least two"):
        timed_path(scene, [LEFT], limits)
    with pytest.raises(WrongSizeError):
        timed_path(scene, [LEFT[:5], RIGHT[:5]], limits)
    with pytest.raises(BadValueError, match="profile"):
        timed_path(scene, [LEFT, LEFT + 0.1], limits, profile="hurry")


def test_carried_objects_and_floors_are_planned_around():
    scene = with_wall(0.7)
    scene.add("floor", Plane((0, 0, 1), -0.02))
    scene.add("rod", Capsule(0.02, 0.3))
    scene.attach("rod", "hand", pose=at(0.0, 0.0, 0.25))
    start, goal = LEFT - [0, 0.4, 0, 0, 0, 0], RIGHT - [0, 0.4, 0, 0, 0, 0]
    solved(scene, start, goal)
