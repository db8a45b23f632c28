"""Torques and wrenches: golden values, power balance, idle wrenches, the way back, refusals."""

import numpy as np
import pytest

from robomech_ros.dynamics import gravity_torque
from robomech_ros.errors import BadValueError, NonFiniteError, UnknownLinkError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import (
    joint_torques,
    point_jacobian,
    singularity_report,
    wrench_from_torques,
)
from robomech_ros.robots import list_robots, load_robot

POINT = (0.05, -0.1, 0.2)


def test_golden_torques_of_the_fanuc_arc_mate(golden):
    case, chain = golden("kinetostatics_fanuc"), load_robot("fanuc_arcmate")
    q, wrench = case["theta"], case["wrench_moment_force"]
    torques = joint_torques(chain, q, wrench)
    np.testing.assert_allclose(torques, case["tau"], rtol=0, atol=1e-11)
    np.testing.assert_allclose(wrench_from_torques(chain, q, torques), wrench, rtol=1e-11)


@pytest.mark.parametrize("robot", list_robots())
def test_power_goes_from_the_joints_to_the_surroundings(robot):
    chain, rng = load_robot(robot), np.random.default_rng(8)
    q, qd = rng.uniform(-2, 2, (2, 50, chain.n))
    wrench = rng.normal(size=(50, 6))
    for axes in (None, chain.tip, chain.links[1], np.diag([1.0, -1.0, -1.0])):
        torques = joint_torques(chain, q, wrench, point=POINT, axes=axes)
        twist = np.einsum("kij,kj->ki", point_jacobian(chain, q, POINT, axes), qd)
        given, taken = (torques * qd).sum(axis=1), (wrench * twist).sum(axis=1)
        np.testing.assert_allclose(given, taken, rtol=1e-12, atol=1e-11)


def test_what_the_tip_exerts_is_minus_what_the_surroundings_exert_on_it():
    """``tip_wrench`` and the wrench of ``joint_torques`` had opposite senses and one name."""
    puma, rng = load_robot("puma560"), np.random.default_rng(6)
    q, wrench = rng.uniform(-2, 2, (20, 6)), rng.normal(size=(20, 6))
    exerted = joint_torques(puma, q, exerted_wrench=-wrench)
    felt = gravity_torque(puma, q, gravity=np.zeros(3), tip_wrench=wrench)
    np.testing.assert_allclose(exerted, felt, rtol=0, atol=1e-13)


@pytest.mark.parametrize("robot", ["puma560", "iiwa14", "stanford"])
def test_a_load_held_at_rest_lowers_the_potential_by_its_weight_times_the_height(robot):
    """Torques are the gradient of the load's potential energy."""
    chain, weight, step = load_robot(robot), 20.0, 1e-6
    q = np.random.default_rng(2).uniform(-1, 1, chain.n)
    point = (*POINT, 1.0)

    def energy(joints):
        return weight * (forward_kinematics(chain, joints) @ point)[2]

    expected = [(energy(q + d) - energy(q - d)) / (2 * step) for d in step * np.eye(chain.n)]
    upwards = (0, 0, 0, 0, 0, weight)
    torques = joint_torques(chain, q, upwards, point=POINT)
    np.testing.assert_allclose(torques, expected, rtol=0, atol=1e-7)


@pytest.mark.parametrize("robot", ["puma560", "ur5e", "panda", "gen3", "stanford", "general7r"])
def test_the_wrench_is_known_from_the_torques(robot):
    chain, rng = load_robot(robot), np.random.default_rng(3)
    q, wrench = rng.uniform(-1, 1, (2, 3, chain.n)) + 0.3, rng.normal(size=(2, 3, 6))
    given = {"point": POINT, "axes": chain.tip}
    torques = joint_torques(chain, q, wrench, **given)
    found = wrench_from_torques(chain, q, torques, length=0.3, **given)
    np.testing.assert_allclose(found, wrench, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(
        joint_torques(chain, q, wrench[0, 0], **given)[0, 0], torques[0, 0]
    )


@pytest.mark.parametrize(
    ("robot", "q"),
    [
        ("puma560", [0.3, 0.4, 0.5, 0.2, 0.0, 0.6]),
        ("ur5e", [0.3, -1.0, 0.0, 0.2, 0.7, 0.6]),
        ("scara", [0.3, 0.0, 0.1, 0.2]),
        ("iiwa14", [0.2, 0.3, 0.4, 0.0, 0.5, 0.6, 0.7]),
    ],
)
def test_singular_arms_resist_some_wrenches_for_free(robot, q):
    chain = load_robot(robot)
    idle = singularity_report(chain, q, point=POINT, length=0.3).idle_wrenches
    assert len(idle) >= 1
    for wrench in idle:
        assert np.linalg.norm(wrench) > 0.1
        np.testing.assert_allclose(joint_torques(chain, q, wrench, point=POINT), 0.0, atol=1e-6)
    if chain.n >= 6:
        assert np.isnan(wrench_from_torques(chain, q, np.ones(chain.n))).all()


def test_what_is_refused():
    puma, q = load_robot("puma560"), np.zeros(6)
    with pytest.raises(WrongSizeError, match=r"exerted_wrench has shape \(5,\)"):
        joint_torques(puma, q, np.zeros(5))
    with pytest.raises(WrongSizeError, match=r"exerted_wrench .*\(6,\) or \(2, 6\), as q"):
        joint_torques(puma, np.zeros((2, 6)), np.zeros((3, 6)))
    with pytest.raises(NonFiniteError, match=r"exerted_wrench\[2\] is nan"):
        joint_torques(puma, q, [0, 0, np.nan, 0, 0, 0])
    with pytest.raises(BadValueError, match="largest of exerted_wrench .*finite torques"):
        joint_torques(puma, q + 0.1, np.full(6, 1.7e308))
    with pytest.raises(UnknownLinkError, match="unknown link 'tol0'.*did you mean 'tool0'"):
        joint_torques(puma, q, np.zeros(6), axes="tol0")
    with pytest.raises(BadValueError, match="scara with 4 joints.*six joints or more"):
        wrench_from_torques(load_robot("scara"), np.zeros(4), np.zeros(4))
    with pytest.raises(BadValueError, match="vx300 with 5 joints"):
        wrench_from_torques(load_robot("vx300"), np.full(5, 0.2), np.zeros(5))
    with pytest.raises(NonFiniteError, match="torques of joint 'elbow'"):
        wrench_from_torques(puma, q, [0, 0, np.inf, 0, 0, 0])
    with pytest.raises(WrongSizeError, match="torques .*as q"):
        wrench_from_torques(puma, np.zeros((2, 6)), np.zeros((3, 6)))
