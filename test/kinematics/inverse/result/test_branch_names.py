"""Names of postures of arms whose descriptions have rounded angles."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinematics.inverse.result.branch_names import distinct_names
from robomech_ros.robots import chain_from_dh, load_robot
from robomech_ros.robots.chain_layout import unpack_chain
from robomech_ros.spatial import matrix_from_roll_pitch_yaw, roll_pitch_yaw_from_matrix

# How far (m) the origins of a URDF's links are from the feet of the common normals, along the
# axes, and by what angle (rad) their frames are turned about them.
SHIFTS = (0.0, 0.12, -0.05, 0.07, 0.11, -0.09)
TURNS = (0.0, np.pi, np.pi / 2, -np.pi / 2, np.pi, np.pi / 2)


def along_and_about(shift, turn):
    pose = np.eye(4)
    c, s = np.cos(turn), np.sin(turn)
    pose[:2, :2] = [[c, -s], [s, c]]
    pose[2, 3] = shift
    return pose


def rounded(name, digits, tilt=0.0):
    """The arm as a URDF has it: origins anywhere along the axes, angles with so many digits.

    Returns it, and the exact arm with the same frames. The third axis is tilted by ``tilt`` (rad).
    """
    arm = load_robot(name)
    frames = [np.eye(4)] + [along_and_about(*one) for one in zip(SHIFTS, TURNS, strict=True)]
    C = unpack_chain(arm.packed)
    C[0] = C[0] @ frames[1]
    for i in range(1, 7):
        following = frames[i + 1] if i < 6 else np.eye(4)
        C[i] = np.linalg.inv(frames[i]) @ C[i] @ following
    exact = chain_of(C, [0] * 6)
    C[2, :3, :3] = C[2, :3, :3] @ matrix_from_roll_pitch_yaw([tilt, 0.0, 0.0])
    for pose in C:
        angles = np.round(roll_pitch_yaw_from_matrix(pose[:3, :3]), digits)
        pose[:3, :3] = matrix_from_roll_pitch_yaw(angles)
    return chain_of(C, [0] * 6), exact


def nearest(result, q):
    turns = np.remainder(result.q - q + np.pi, 2 * np.pi) - np.pi
    away = np.abs(turns).max(axis=1)
    return int(np.argmin(away)), float(away.min())


ARMS = [("puma560", 4), ("puma560", 3), ("irb120", 4), ("ur5e", 4), ("ur10e", 3)]


@pytest.mark.parametrize(("name", "digits"), ARMS)
def test_postures_of_rounded_arms_have_the_names_of_the_exact_ones(name, digits):
    arm, exact = rounded(name, digits)
    rng = np.random.default_rng(4)
    numbered = 0
    for q in rng.uniform(-np.pi, np.pi, (60, 6)):
        ours = inverse_kinematics(arm, forward_kinematics(arm, q))
        theirs = inverse_kinematics(exact, forward_kinematics(exact, q))
        k, away = nearest(ours, q)
        name = theirs.branches[nearest(theirs, q)[0]]
        assert away < 1e-6
        assert ours.branches[k].startswith(name)
        assert len(set(ours.branches)) == len(ours)
        if any("number" in name for name in ours.branches):
            numbered += 1
        elif len(ours) == len(theirs):
            assert set(ours.branches) == set(theirs.branches)
    assert ours.family in ("general-6r", "three-parallel")
    # Those beside a singular posture.
    assert numbered <= 2


def test_an_arm_with_a_tilted_axis_is_solved_as_a_general_one_and_named():
    arm, _ = rounded("ur5e", 6, tilt=5e-4)
    q = np.array([0.4, -1.1, 1.3, -0.5, 0.9, 0.2])
    result = inverse_kinematics(arm, forward_kinematics(arm, q))
    assert result.family == "general-6r" and result.complete and len(result) == 8
    assert all(name.startswith("shoulder-") for name in result.branches)
    far, _ = rounded("ur5e", 6, tilt=5e-3)
    result = inverse_kinematics(far, forward_kinematics(far, q))
    assert result.family == "general-6r"
    assert all(name.startswith("posture-") for name in result.branches)


@pytest.mark.parametrize("bend", [0.0, 1e-7, 1e-5, 1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize(("joint", "singular"), [(4, 0.0), (2, None)])
def test_names_beside_singular_postures_are_all_different(joint, singular, bend):
    arm, _ = rounded("puma560", 4)
    stretched = np.arctan2(0.4331, -0.0203) if singular is None else singular
    for sign in (-1.0, 1.0):
        q = np.array([0.5, -0.7, 0.8, 0.3, 0.9, -0.4])
        q[joint] = stretched + sign * bend
        result = inverse_kinematics(arm, forward_kinematics(arm, q), seed=q)
        assert result.position_error.max() < 1e-9
        assert "" not in result.branches
        assert len(set(result.branches)) == len(result)


def test_windings_of_one_posture_keep_one_name_and_others_are_numbered():
    arm = load_robot("puma560")
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    other = q + [0.0, 0.0, 0.0, 0.0, 0.0, 0.01]
    wound = q + [2 * np.pi, 0.0, 0.0, 0.0, 0.0, 0.0]
    names = ("elbow-up",) * 3
    assert distinct_names(arm, np.array([q, wound, wound]), names) == names
    numbered = distinct_names(arm, np.array([other, q, wound]), names)
    assert numbered == ("elbow-up number-2", "elbow-up number-1", "elbow-up number-1")
    assert distinct_names(arm, np.array([wound, other, q]), names)[1] == "elbow-up number-2"
    assert distinct_names(arm, np.array([q, other]), ("", "")) == ("", "")


XYZ, XY_RZ = (1, 1, 1, 0, 0, 0), (1, 1, 0, 0, 0, 1)


@pytest.mark.parametrize(
    ("name", "mask"),
    [
        ("planar3r", None),
        ("planar3r", XY_RZ),
        ("planar3r", (1, 1, 0, 0, 0, 0)),
        ("scara", None),
        ("ur5e", XYZ),
        ("ur5e", (1, 1, 1, 1, 1, 0)),
        ("puma560", XYZ),
        ("panda", XYZ),
    ],
)
def test_issue_12_names_are_unique_of_partial_tasks_and_planar_arms(name, mask):
    """They were empty; the seed changes the order of the postures and not their names."""
    chain = load_robot(name)
    q = chain.midrange() + 0.3
    T = forward_kinematics(chain, q)
    result = inverse_kinematics(chain, T, seed=q, task_mask=mask, respect_limits=False)
    assert len(set(result.branches)) == len(result) > 1
    assert "" not in result.branches
    if mask is None:
        other = inverse_kinematics(chain, T, seed=q - 1.0, respect_limits=False)
        for posture, name in zip(other.q, other.branches, strict=True):
            k, away = nearest(result, posture)
            assert away < 1e-9 and result.branches[k] == name


@pytest.mark.parametrize("mask", [None, XY_RZ])
def test_issue_12_a_double_root_of_a_planar_arm_is_at_the_boundary(mask):
    chain = load_robot("planar3r")
    for q, count in (([0.3, 0.0, 0.4], 1), ([0.3, 0.02, 0.4], 2)):
        result = inverse_kinematics(chain, forward_kinematics(chain, q), seed=q, task_mask=mask)
        assert len(result) == count and not result.continuum
        assert all(name.endswith(" at-boundary") == (count == 1) for name in result.branches)


def test_issue_12_double_roots_of_a_spatial_3r_arm_are_at_the_boundary():
    chain = chain_from_dh([0.0, 0.4, 0.3], [0.3, 0.0, 0.0], [np.pi / 2, 0.0, 0.0])
    for q, count in (([0.3, 0.5, 0.0], 2), ([0.3, 0.5, 0.7], 4)):
        T = forward_kinematics(chain, q)
        result = inverse_kinematics(chain, T, seed=q, task_mask=XYZ, respect_limits=False)
        assert len(set(result.branches)) == len(result) == count
        assert all(("at-boundary" in name) == (q[2] == 0.0) for name in result.branches)
