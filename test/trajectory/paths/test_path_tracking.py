"""Joint paths: exact rates along the path, tracking, spline synthesis, motions, bad input."""

from functools import partial

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot
from robomech_ros.spatial import matrix_from_rotation_vector
from robomech_ros.trajectory import (
    Limits,
    PathTrackingStatus,
    SerialArm,
    constant_orientation,
    geodesic_orientation,
    helix,
    joint_spline,
    line,
    point_to_point,
    pose_path,
    spline_path,
    straight_path,
    track_path,
    tracking_error,
    viviani,
)
from robomech_ros.trajectory.paths.posture import corrected, posture

START = {
    "puma560": [0.1, -0.5, 0.4, 0.3, 0.8, 0.2],
    "ur5e": [0.3, -1.1, 1.4, -0.6, 1.1, 0.2],
    "stanford": [0.2, 1.1, 0.5, 0.4, 0.9, -0.3],
    "diestro": [-0.6, -1.4, 1.7, -1.4, 1.8, -0.8],
    "panda": [0.2, -0.4, 0.3, -1.8, 0.2, 1.7, 0.4],
    "iiwa14": [0.3, 0.6, -0.2, -1.3, 0.4, 0.9, 0.1],
    "vx300": [0.2, -0.3, 0.5, 0.4, 0.3],
    "scara": [0.4, 0.9, 0.1, -0.3],
    "planar3r": [0.3, 0.9, 0.4],
}
REDUNDANT = ["panda", "iiwa14"]
FULL = [name for name, q in START.items() if len(q) >= 6]


def arm_of(name):
    chain = load_robot(name)

    def inverse(T, near):
        found = inverse_kinematics(chain, T, seed=near, respect_limits=False)
        return found.q[0] if len(found.q) else None

    return SerialArm(partial(forward_kinematics, chain), inverse, partial(jacobian, chain))


def poses_near(name, arm, count=4, reach=0.4):
    rng = np.random.default_rng(11)
    q = np.array(START[name])
    rows = [q, *(q + reach * rng.uniform(-1.0, 1.0, (count - 1, len(q))))]
    return np.stack([arm.forward(row) for row in rows])


@pytest.mark.parametrize("name", START)
def test_the_rate_of_the_jacobian_follows_from_the_jacobian(name):
    arm = arm_of(name)
    rng = np.random.default_rng(2)
    h = 1e-6
    for _ in range(5):
        q, qd = rng.uniform(-1.0, 1.0, (2, len(START[name])))
        rate = (arm.jacobian(q + h * qd) - arm.jacobian(q - h * qd)) / (2.0 * h)
        np.testing.assert_allclose(arm.jacobian_rate(q, qd), rate, atol=1e-8)


@pytest.mark.parametrize("make", [straight_path, spline_path])
@pytest.mark.parametrize("name", FULL)
def test_the_joints_follow_the_path_within_the_tolerance(name, make):
    arm = arm_of(name)
    path = make(poses_near(name, arm))
    for tolerance in (1e-5, 1e-8):
        found = track_path(path, arm, START[name], tolerance=tolerance)
        assert found.status is PathTrackingStatus.COMPLETE and not found.reason
        assert found.reached == path.length == found.path.length
        s = np.linspace(0.0, path.length, 400)
        error = np.abs(tracking_error(path, arm, found.path, s)).max()
        assert error < 2.0 * tolerance
    np.testing.assert_array_equal(found.path.stops, path.stops)
    np.testing.assert_allclose(found.path.derivatives(0.0)[0], START[name], atol=1e-9)


def test_short_legs_beside_long_ones_are_followed():
    arm = arm_of("puma560")
    pose = arm.forward(START["puma560"])
    poses = [pose.copy() for _ in range(4)]
    for k, x in enumerate((0.0, 1e-6, 0.1, 0.1 + 3e-8)):
        poses[k][:3, 3] += [x, 0.5 * x * x, 0.0]
    path = straight_path(poses)
    found = track_path(path, arm, START["puma560"])
    assert found.status is PathTrackingStatus.COMPLETE, found.reason


@pytest.mark.parametrize("name", FULL)
def test_the_joint_path_is_c2_but_for_the_stops(name):
    arm = arm_of(name)
    for make in (straight_path, spline_path):
        path = make(poses_near(name, arm))
        found = track_path(path, arm, START[name], tolerance=1e-6).path
        inner = found.pieces.breaks[1:-1]
        smooth = inner[~np.isin(inner, found.stops)]
        before, after = found.derivatives(np.nextafter(smooth, 0.0)), found.derivatives(smooth)
        for k in range(3):
            size = max(1.0, np.abs(after[k]).max())
            np.testing.assert_allclose(before[k], after[k], atol=1e-8 * size)
        before, after = (found.derivatives(at) for at in (found.stops - 1e-12, found.stops))
        np.testing.assert_allclose(before[0], after[0], atol=1e-9)
        assert (np.abs(after[1] - before[1]).max(axis=1) > 1e-2).all()


@pytest.mark.parametrize("name", START)
def test_the_rates_are_the_derivatives_of_the_joint_values(name):
    """A line for which an arm of any number of joints has a posture: its own motion."""
    arm = arm_of(name)
    q = np.array(START[name])
    if len(q) >= 6:
        pose = arm.forward(q)
        path = pose_path(viviani(0.01, pose=pose), constant_orientation(pose[:3, :3]))
        q = arm.inverse(path.sample(0.0).pose, q)
    else:
        still = arm.forward(q)
        path = small_path(name, still, [0.1, -0.05, 0.02 if name == "scara" else 0.0])
    h = 1e-5 * path.length
    s = 0.3 * path.length
    row = [corrected(arm, q, path.sample(s).pose)]
    row += [corrected(arm, row[0], path.sample(s + d).pose) for d in (-h, h)]
    found = posture(arm, row[0], path.sample(s))
    size = np.abs(found.first).max()
    if name in REDUNDANT:
        row = least_motion(arm, path, row[0], s, h)
    np.testing.assert_allclose(found.first, (row[2] - row[1]) / (2.0 * h), atol=1e-6 * size)
    second = (row[2] - 2.0 * row[0] + row[1]) / h**2
    np.testing.assert_allclose(found.second, second, atol=1e-3 * size + 1e-2)


def least_motion(arm, path, q, s, h):
    """Joint values at s, s - h and s + h by integrating the least joint rates."""

    def rates(x, at):
        return np.linalg.pinv(arm.jacobian(x)) @ path.sample(at).twist

    rows = [q]
    for step in (-h, h):
        k1 = rates(q, s)
        k2 = rates(q + 0.5 * step * k1, s + 0.5 * step)
        k3 = rates(q + 0.5 * step * k2, s + 0.5 * step)
        k4 = rates(q + step * k3, s + step)
        rows.append(q + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))
    return rows


@pytest.mark.parametrize("name", REDUNDANT)
def test_redundant_arms_move_with_the_least_joint_rates(name):
    arm = arm_of(name)
    path = spline_path(poses_near(name, arm))
    found = track_path(path, arm, START[name], tolerance=1e-8).path
    for s in np.linspace(0.0, path.length, 40):
        q, first, _, _ = found.derivatives(s)
        least = np.linalg.pinv(arm.jacobian(q)) @ path.sample(s).twist
        np.testing.assert_allclose(first, least, atol=2e-3 * np.linalg.norm(least))


def small_path(name, pose, way):
    """Build a path that an arm of fewer than six joints can follow."""
    turned = pose.copy()
    turn = [0.0, 0.0, 0.2]
    if name == "vx300":
        # About the vertical axis of the base: the first joint alone.
        turned[:3, :3] = matrix_from_rotation_vector(turn) @ pose[:3, :3]
        radius = np.hypot(*pose[:2, 3])
        begin = np.arctan2(pose[1, 3], pose[0, 3])
        lift = np.eye(4)
        lift[2, 3] = pose[2, 3]
        curve = helix(radius, 0.0, 0.2, start=begin, pose=lift)
        ends = [pose[:3, :3], turned[:3, :3]]
        return pose_path(curve, geodesic_orientation(ends, curve.breaks))
    turned[:3, :3] = matrix_from_rotation_vector(turn) @ pose[:3, :3]
    turned[:3, 3] += way
    return straight_path([pose, turned])


@pytest.mark.parametrize("name", ["scara", "planar3r", "vx300"])
def test_arms_of_fewer_joints_follow_paths_they_can(name):
    arm = arm_of(name)
    pose = arm.forward(START[name])
    path = small_path(name, pose, [0.1, -0.05, 0.02 if name == "scara" else 0.0])
    found = track_path(path, arm, START[name])
    assert found.status is PathTrackingStatus.COMPLETE, found.reason
    s = np.linspace(0.0, path.length, 50)
    assert np.abs(tracking_error(path, arm, found.path, s)).max() < 2e-7


def test_the_error_of_a_spline_falls_with_the_fourth_power_of_the_poses():
    arm = arm_of("puma560")
    pose = arm.forward(START["puma560"])
    path = pose_path(viviani(0.05, pose=pose), constant_orientation(pose[:3, :3]))
    joints = track_path(path, arm, START["puma560"]).path
    s = np.linspace(0.0, path.length, 1000)

    def error(count, ends):
        spline = joint_spline(path, arm, joints, count, ends=ends)
        assert len(spline.pieces.breaks) == count
        return np.abs(tracking_error(path, arm, spline, s)).max()

    for ends in ("clamped", "periodic"):
        errors = [error(count, ends) for count in (41, 81, 161)]
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        assert (orders > 3.7).all() and (orders < 4.6).all(), orders
    errors = [error(count, "natural") for count in (81, 161)]
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.5


def test_the_error_between_exact_postures_falls_with_the_sixth_power():
    arm = arm_of("ur5e")
    path = spline_path(poses_near("ur5e", arm))
    counts, errors = [], []
    for tolerance in (1e-5, 1e-7, 1e-9):
        found = track_path(path, arm, START["ur5e"], tolerance=tolerance).path
        s = np.linspace(0.0, path.length, 500)
        counts.append(len(found.pieces.breaks))
        errors.append(np.abs(tracking_error(path, arm, found, s)).max())
    order = np.log(errors[0] / errors[2]) / np.log(counts[2] / counts[0])
    assert order > 4.5


def test_a_spline_passes_stops_with_the_rates_of_both_sides():
    arm = arm_of("puma560")
    path = straight_path(poses_near("puma560", arm, 3))
    joints = track_path(path, arm, START["puma560"]).path
    spline = joint_spline(path, arm, joints, 60)
    np.testing.assert_array_equal(spline.stops, path.stops)
    for s in (np.nextafter(path.stops, 0.0), path.stops):
        rates = spline.derivatives(s)[1] - joints.derivatives(s)[1]
        np.testing.assert_allclose(rates, 0.0, atol=1e-8)
    s = np.linspace(0.0, path.length, 300)
    assert np.abs(tracking_error(path, arm, spline, s)).max() < 1e-7


def test_a_path_out_of_reach_is_followed_as_far_as_it_goes():
    arm = arm_of("puma560")
    poses = poses_near("puma560", arm, 2)
    poses[1, :3, 3] *= 4.0
    path = straight_path(poses)
    found = track_path(path, arm, START["puma560"])
    assert found.status is PathTrackingStatus.LOST
    assert 0.0 < found.reached < path.length
    assert f"at s = {found.reached:.6g} of" in found.reason and "no posture" in found.reason
    assert found.path.length == found.reached
    s = np.linspace(0.0, found.reached, 100)
    assert np.abs(tracking_error(path, arm, found.path, s)).max() < 2e-7
    beyond = path.sample(min(found.reached + 2e-3 * path.length, path.length)).pose
    assert arm.inverse(beyond, np.array(START["puma560"])) is None


def test_a_start_out_of_reach_is_told():
    arm = arm_of("puma560")
    path = pose_path(line([9.0, 0, 0], [9.0, 1, 0]), constant_orientation(np.eye(3)))
    found = track_path(path, arm, START["puma560"])
    assert found.status is PathTrackingStatus.NO_START and found.path is None
    assert found.reached == 0.0 and "start" in found.reason


def test_a_singular_path_ends_where_the_condition_number_does():
    arm = arm_of("puma560")
    q = np.array(START["puma560"])
    singular = q.copy()
    singular[[0, 3, 4]] += [0.3, 0.5, -q[4]]
    path = straight_path([arm.forward(q), arm.forward(singular)])
    found = track_path(path, arm, q, condition_limit=200.0)
    assert found.status is PathTrackingStatus.SINGULAR
    assert "condition number rises to" in found.reason and "over 200" in found.reason
    last = found.path.derivatives(found.reached)[0]
    assert np.linalg.cond(arm.jacobian(last)) == pytest.approx(200.0, rel=1e-2)
    unlimited = track_path(path, arm, q, condition_limit=1e30)
    assert unlimited.reached > found.reached
    at_once = track_path(path, arm, q, condition_limit=1.5)
    assert at_once.status is PathTrackingStatus.SINGULAR and at_once.path is None


def test_the_branch_is_that_of_the_joints_given():
    arm = arm_of("puma560")
    chain = load_robot("puma560")
    path = straight_path(poses_near("puma560", arm, 2, 0.2))
    starts = inverse_kinematics(chain, path.sample(0.0).pose, respect_limits=False).q
    assert len(starts) == 8
    for start in starts:
        found = track_path(path, arm, start + 1e-5)
        if found.path is not None:
            np.testing.assert_allclose(found.path.derivatives(0.0)[0], start, atol=1e-6)


@pytest.fixture(scope="module")
def followed():
    arm = arm_of("puma560")
    path = spline_path(poses_near("puma560", arm))
    return track_path(path, arm, START["puma560"]).path


@pytest.mark.parametrize("profile", ["poly345", "ruckig"])
def test_a_time_law_runs_along_by_the_chain_rule(followed, profile):
    limits = Limits(["s"], velocity=0.2, acceleration=0.5, jerk=2.0)
    law = point_to_point([0.0], [followed.length], limits=limits, profile=profile)
    motion = followed.along(law)
    assert motion.duration == law.duration
    h = 1e-5
    t = np.linspace(0.0, law.duration, 41)[1:-1]
    t = t[np.abs(t[:, None] - law.pieces.breaks).min(axis=1) > 2.0 * h]
    s = law.sample(t).position
    t = t[np.abs(s - followed.pieces.breaks).min(axis=1) > 1e-4]
    here, after, before = (motion.sample(t + d) for d in (0.0, h, -h))
    for k in range(3):
        rate = (after[k] - before[k]) / (2.0 * h)
        size = np.abs(here[k + 1]).max()
        np.testing.assert_allclose(here[k + 1], rate, atol=1e-5 * size)
    for one, row in zip(motion.sample(float(t[3])), here, strict=True):
        np.testing.assert_array_equal(one, row[3])
    ends = motion.sample([-1.0, 0.0, law.duration, law.duration + 1.0])
    np.testing.assert_allclose(ends.velocity, 0.0, atol=1e-12)
    np.testing.assert_allclose(ends.position[::3], followed.derivatives([0, followed.length])[0])


def test_a_law_that_passes_a_stop_moving_is_refused():
    arm = arm_of("puma560")
    path = straight_path(poses_near("puma560", arm, 3))
    joints = track_path(path, arm, START["puma560"]).path
    limits = Limits(["s"], velocity=0.2, acceleration=0.5)
    through = point_to_point([0.0], [path.length], limits=limits)
    with pytest.raises(BadValueError, match="speed of the law at the stop") as caught:
        joints.along(through)
    assert caught.value.value > 0.01
    to_the_stop = point_to_point([0.0], [float(path.stops[0])], limits=limits)
    assert joints.along(to_the_stop).duration == to_the_stop.duration


class BrokenArm:
    def __init__(self, arm, **replaced):
        for name in ("forward", "inverse", "jacobian", "jacobian_rate"):
            setattr(self, name, replaced.get(name, getattr(arm, name)))


def bad_calls():
    arm = arm_of("puma560")
    q = START["puma560"]
    path = straight_path(poses_near("puma560", arm, 2, 0.1))
    joints = track_path(path, arm, q).path
    limits = Limits(["a", "b"], velocity=1.0, acceleration=1.0)
    law = point_to_point([0, 0], [1, 1], limits=limits)
    one = Limits(["s"], velocity=1.0, acceleration=1.0)
    far = point_to_point([0], [9], limits=one)
    back = point_to_point([joints.length], [0], limits=one)
    nan = BrokenArm(arm, jacobian=lambda q: np.full((6, 6), np.nan))
    thin = BrokenArm(arm, jacobian=lambda q: np.zeros((6, 5)))
    return {
        "path": (lambda: track_path(1, arm, q), BadValueError, "path is 1, expected a PosePath"),
        "arm": (lambda: track_path(path, 1, q), BadValueError, "arm is 1, expected an arm with"),
        "seven": (lambda: track_path(path, arm, [0.0] * 7), WrongSizeError, r"\(7,\)"),
        "empty": (lambda: track_path(path, arm, []), WrongSizeError, "at least one joint"),
        "NaN": (lambda: track_path(path, arm, [np.nan] * 6), NonFiniteError, r"near\[0\] is nan"),
        "tolerance": (
            lambda: track_path(path, arm, q, tolerance=1e-15),
            BadValueError,
            "tolerance is 1e-15, expected at least 1e-10",
        ),
        "limit": (
            lambda: track_path(path, arm, q, condition_limit=0),
            BadValueError,
            "condition_limit is 0.0",
        ),
        "NaN Jacobian": (lambda: track_path(path, nan, q), NonFiniteError, r"jacobian\[0, 0\]"),
        "thin": (lambda: track_path(path, thin, q), WrongSizeError, r"jacobian has shape \(6, 5\)"),
        "callable": (lambda: SerialArm(1, 2, 3), BadValueError, "forward is 1"),
        "poses": (lambda: joint_spline(path, arm, joints, 1), BadValueError, "poses is 1"),
        "half": (lambda: joint_spline(path, arm, joints, 4.5), BadValueError, "poses is 4.5"),
        "no joints": (lambda: joint_spline(path, arm, 1, 4), BadValueError, "joints is 1"),
        "open": (
            lambda: joint_spline(path, arm, joints, 9, ends="periodic"),
            BadValueError,
            r"joint \d at the end of the path is",
        ),
        "law": (lambda: joints.along(3), BadValueError, "law is 3"),
        "two": (lambda: joints.along(law), BadValueError, "of one joint"),
        "far": (lambda: joints.along(far), BadValueError, "end of the law is 9.0, expected from 0"),
        "back": (lambda: joints.along(back), BadValueError, "end of the law is 0.0, expected at"),
        "off": (lambda: joints.derivatives(-1.0), BadValueError, "s is -1.0"),
    }


BAD = bad_calls()


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_named(name):
    call, error, text = BAD[name]
    with pytest.raises(error, match=text):
        call()
