"""Forward kinematics: golden poses, a NumPy oracle, Pinocchio, and what is refused."""

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, UnknownLinkError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, link_poses
from robomech_ros.robots import chain_from_dh, list_robots, load_robot

SIX = pytest.mark.parametrize("seed", range(20))
ROBOTS = pytest.mark.parametrize("robot", list_robots())
GOLDENS = (
    "decoupled_general_8",
    "decoupled_irb2000",
    "decoupled_puma560",
    "ik6r_diestro_generic",
    "ik6r_diestro_recalled_pose",
    "ik6r_fanuc_arcmate_generic",
    "ik6r_fanuc_arcmate_recalled_pose",
    "ik6r_manocha_canny_16",
    "ik6r_manocha_code_ex2",
    "ik6r_tsai_morgan_1",
    "ik6r_tsai_morgan_3",
)


def oracle(chain, q):
    """The product of matrices, joint by joint, as the model defines it."""
    T = np.eye(4)
    for i, row in enumerate(chain.packed):
        C = np.eye(4)
        C[:3, :3], C[:3, 3] = row[1:10].reshape(3, 3), row[10:]
        T = T @ C
        if i < chain.n:
            J = np.eye(4)
            if chain.types[i] == 0:
                c, s = np.cos(q[i]), np.sin(q[i])
                J[:2, :2] = [[c, -s], [s, c]]
            else:
                J[2, 3] = q[i]
            T = T @ J
    return T


def postures(chain, count, seed=0):
    """Random joint values within the limits, within a turn or a metre where there is none."""
    rng = np.random.default_rng(seed)
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    return rng.uniform(lower, upper, size=(count, chain.n))


@pytest.mark.parametrize("name", GOLDENS)
def test_every_golden_solution_gives_the_golden_pose(golden, name):
    case = golden(name)
    chain = chain_from_dh(case["a"], case["b"], case["alpha"])
    poses = forward_kinematics(chain, case["solutions"])
    np.testing.assert_allclose(
        poses[:, :3, :3], np.broadcast_to(case["R"], (len(poses), 3, 3)), atol=1e-12
    )
    np.testing.assert_allclose(poses[:, :3, 3], np.tile(case["p"], (len(poses), 1)), atol=1e-12)


def test_golden_pose_of_the_kinetostatics_file(golden):
    case = golden("kinetostatics_fanuc")
    pose = forward_kinematics(load_robot("fanuc_arcmate"), case["theta"])
    np.testing.assert_allclose(pose, case["T"], rtol=0, atol=1e-12)


def test_golden_wrist_centre_of_the_orthogonal_arm(golden):
    case = golden("decoupled_orthogonal_arm")
    chain = chain_from_dh(
        [*case["a"], 0.0], [*case["b"], case["b4"]], [*case["alpha"], 0.0], types="RRRR"
    )
    for solution in case["solutions"]:
        centre = forward_kinematics(chain, [*solution, 0.0])[:3, 3]
        np.testing.assert_allclose(centre, case["C"], rtol=0, atol=1e-10)


@ROBOTS
def test_agrees_with_pinocchio(robot, pinocchio_model):
    chain = load_robot(robot)
    model = pinocchio_model(robot)
    data = model.createData()
    tip = model.getFrameId(chain.tip)
    q = postures(chain, 200)
    for row, pose in zip(q, forward_kinematics(chain, q), strict=True):
        pinocchio.framesForwardKinematics(model, data, row)
        np.testing.assert_allclose(pose, data.oMf[tip].homogeneous, rtol=0, atol=1e-12)


@pytest.mark.parametrize("robot", ["irb120", "panda", "ur5e"])
def test_links_agree_with_pinocchio(robot, pinocchio_model):
    chain = load_robot(robot)
    model = pinocchio_model(robot)
    data = model.createData()
    q = postures(chain, 1)[0]
    pinocchio.framesForwardKinematics(model, data, q)
    names = [frame.name for frame in chain.frames]
    for name, pose in zip(names, link_poses(chain, q, names), strict=True):
        expected = data.oMf[model.getFrameId(name)].homogeneous
        np.testing.assert_allclose(pose, expected, rtol=0, atol=1e-12)


@SIX
def test_agrees_with_the_oracle_on_random_chains(random_chain, seed):
    chain = random_chain(seed, n=1 + seed % 8)
    q = postures(chain, 5, seed)
    for row, pose in zip(q, forward_kinematics(chain, q), strict=True):
        np.testing.assert_allclose(pose, oracle(chain, row), rtol=0, atol=1e-13)


def test_a_batch_has_the_bytes_of_single_calls():
    chain = load_robot("puma560")
    q = postures(chain, 24).reshape(2, 3, 4, 6)
    poses = forward_kinematics(chain, q)
    assert poses.shape == (2, 3, 4, 4, 4)
    for index in np.ndindex(2, 3, 4):
        assert poses[index].tobytes() == forward_kinematics(chain, q[index]).tobytes()
    assert forward_kinematics(chain, np.empty((0, 6))).shape == (0, 4, 4)
    assert forward_kinematics(chain, np.empty((3, 0, 6))).shape == (3, 0, 4, 4)


def test_any_layout_and_kind_of_real_numbers_is_taken():
    chain = load_robot("puma560")
    q = postures(chain, 6)
    expected = forward_kinematics(chain, q)
    np.testing.assert_array_equal(forward_kinematics(chain, np.asfortranarray(q)), expected)
    np.testing.assert_array_equal(forward_kinematics(chain, q[::-1])[::-1], expected)
    np.testing.assert_array_equal(forward_kinematics(chain, q.tolist()), expected)
    np.testing.assert_array_equal(forward_kinematics(chain, q.astype(">f8")), expected)
    read_only = q.copy()
    read_only.setflags(write=False)
    np.testing.assert_array_equal(forward_kinematics(chain, read_only), expected)
    whole = forward_kinematics(chain, [0, 1, 0, 2, 0, 1])
    np.testing.assert_array_equal(whole, forward_kinematics(chain, [0.0, 1.0, 0.0, 2.0, 0.0, 1.0]))


def test_results_do_not_share_memory():
    chain = load_robot("puma560")
    first = forward_kinematics(chain, np.zeros(6))
    kept = first.copy()
    forward_kinematics(chain, np.ones(6))
    np.testing.assert_array_equal(first, kept)


def test_links_in_batches_and_the_base_itself():
    chain = load_robot("ur5e")
    q = postures(chain, 3)
    poses = link_poses(chain, q)
    assert poses.shape == (3, len(chain.links), 4, 4)
    np.testing.assert_array_equal(poses[:, 0], np.tile(np.eye(4), (3, 1, 1)))
    np.testing.assert_array_equal(poses[:, -1], forward_kinematics(chain, q))
    only_base = forward_kinematics(chain.with_tip("base_link"), np.empty((3, 0)))
    np.testing.assert_array_equal(only_base, poses[:, 0])


@pytest.mark.parametrize(
    ("q", "error", "text"),
    [
        ([0, 0, 0], WrongSizeError, r"q has shape \(3,\), expected \(6,\) or \(\.\.\., 6\) for "),
        (np.zeros((6, 1)), WrongSizeError, r"shape \(6, 1\)"),
        (0.0, WrongSizeError, r"shape \(\)"),
        ([], WrongSizeError, r"shape \(0,\)"),
        ([0, 0, np.nan, 0, 0, 0], NonFiniteError, "q of joint 'elbow' is nan"),
        ([0, 0, 0, 0, 0, -np.inf], NonFiniteError, "q of joint 'wrist_swivel' is -inf"),
        ([[0] * 6, [0, np.inf, 0, 0, 0, 0]], NonFiniteError, "'shoulder' in row 1 is inf"),
        ("123456", BadValueError, "array of real numbers"),
        (["0"] * 6, BadValueError, "array of real numbers"),
        ([1j] * 6, BadValueError, "array of real numbers"),
        ([True] * 6, BadValueError, "array of real numbers"),
        (None, BadValueError, "array of real numbers"),
        ([[0], [0, 1]], BadValueError, "array of real numbers"),
    ],
)
def test_bad_joint_values_are_refused(q, error, text):
    with pytest.raises(error, match=text):
        forward_kinematics(load_robot("puma560"), q)


def test_an_unknown_link_is_named_with_those_there_are():
    with pytest.raises(UnknownLinkError, match=r"'tol0' \(did you mean 'tool0'\?\); available: b"):
        link_poses(load_robot("puma560"), np.zeros(6), ["base_link", "tol0"])
    with pytest.raises(NonFiniteError, match="q of joint 'waist'"):
        link_poses(load_robot("puma560"), [np.nan, 0, 0, 0, 0, 0], ["base_link"])


def test_a_prismatic_joint_far_out_is_still_finite():
    chain = chain_from_dh([0], [0], [0], types="P")
    assert forward_kinematics(chain, [1e300])[2, 3] == 1e300
    with pytest.raises(NonFiniteError):
        forward_kinematics(chain, [np.nan])
