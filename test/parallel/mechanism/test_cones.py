"""Cones of universal and spherical joints as limits of a mechanism."""

import numpy as np
import pytest

from robomech_ros.outcomes import Code
from robomech_ros.parallel import StewartGough, load_parallel
from robomech_ros.spatial import matrix_from_roll_pitch_yaw

HEXAPOD = load_parallel("hexapod")


def with_cones(base=0.6, platform=0.7):
    """The hexapod with cones about the directions of its legs at home."""
    T = HEXAPOD.mechanism.pose(HEXAPOD.mechanism.home())
    legs = HEXAPOD.platform_points @ T[:3, :3].T + T[:3, 3] - HEXAPOD.base_points
    return StewartGough(
        HEXAPOD.base_points,
        HEXAPOD.platform_points,
        strokes=HEXAPOD.strokes,
        base_cones={"axes": legs + [0.02, 0.0, 0.0], "angles": base},
        platform_cones={"axes": -legs @ T[:3, :3], "angles": platform},
    )


def poses(count):
    """Poses around home, many of them outside the cones."""
    rng = np.random.default_rng(4)
    home = HEXAPOD.mechanism.pose(HEXAPOD.mechanism.home())
    T = np.tile(home, (count, 1, 1))
    T[:, :3, :3] = T[:, :3, :3] @ matrix_from_roll_pitch_yaw(rng.uniform(-0.6, 0.6, (count, 3)))
    T[:, :3, 3] += rng.uniform(-0.25, 0.25, (count, 3))
    return T


def test_joints_bend_as_legs_do():
    robot = with_cones()
    mechanism = robot.mechanism
    seen = set()
    for T in poses(200):
        q = mechanism.postures(T, ignore_limits=True).q[0]
        assert np.abs(mechanism.pose(q) - T).max() <= 1e-12
        excess = dict(zip(mechanism.joint_names, mechanism.limit_excess(q), strict=True))
        for k, end in enumerate(("base", "platform")):
            expected = robot.cone_excess(T)[k]
            found = [excess[f"leg{i + 1}_{end}_x"] for i in range(6)]
            assert np.abs(found - expected).max() <= 1e-12
            seen.add((k, bool(expected.any())))
    assert len(seen) == 4


def test_a_pose_is_excluded_exactly_where_a_stroke_or_a_cone_is():
    robot = with_cones()
    for T in poses(200):
        outside = robot.excess(robot.inverse(T)).any() or robot.cone_excess(T).any()
        found = robot.mechanism.postures(T)
        assert found.status == (Code.LIMITS_EXCLUDE_ALL if outside else Code.NONE)
        if outside:
            worst = max(np.abs(robot.excess(robot.inverse(T))).max(), robot.cone_excess(T).max())
            assert found.excess.max() == pytest.approx(worst, abs=1e-12)


def test_home_is_inside_the_cones_and_the_box_of_limits_holds_them():
    robot = with_cones(0.5, 0.4)
    mechanism = robot.mechanism
    assert not mechanism.limit_excess(mechanism.home()).any()
    index = [mechanism.joint_names.index(f"leg3_{end}_y") for end in ("base", "platform")]
    assert mechanism.upper[index].tolist() == [0.5, 0.4]
    assert mechanism.lower[index].tolist() == [-0.5, -0.4]


def test_cones_of_a_document_bound_what_bends_not_each_joint():
    mechanism = load_parallel("tripod_3prs")
    q = mechanism.home()
    x = mechanism.joint_names.index("leg1_ball_x")
    q[x], q[x + 1] = 0.3, 0.4
    assert mechanism.limit_margin(q)[x] == pytest.approx(
        0.8 - np.arccos(np.cos(0.3) * np.cos(0.4)), abs=1e-12
    )
    q[x], q[x + 1] = 0.7, 0.7
    bend = np.arccos(np.cos(0.7) ** 2)
    assert bend > 0.8
    excess = mechanism.limit_excess(q)
    assert excess[x] == pytest.approx(bend - 0.8, abs=1e-12)
    assert np.count_nonzero(excess) == 1
    assert mechanism.limit_margin(q).min() == -excess[x]


def test_a_joint_that_has_turned_over_is_outside_its_limits():
    mechanism = load_parallel("linapod")
    assert len(mechanism.postures(mechanism.pose(mechanism.home()))) == 1
    x = mechanism.joint_names.index("leg2_foot_x")
    q = mechanism.home()
    q[x], q[x + 1] = np.pi, np.pi
    assert mechanism.limit_excess(q)[x + 1] == pytest.approx(np.pi / 2)
