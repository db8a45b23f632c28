"""Forces at the feet, against a general optimiser; loads that feet cannot carry."""

import re

import numpy as np
import pytest
from scipy.optimize import minimize

from robomech_ros.errors import (
    BadValueError,
    LimitExceededError,
    MissingSupportError,
    WrongSizeError,
)
from robomech_ros.walking import foot_forces, load_legged

MU = 0.6
UP = np.array([0.0, 0.0, 1.0])
EASY = np.array([0.0, 0.0, 0.0, 0.0, 0.0, -110.0])


@pytest.fixture(scope="module")
def robot():
    return load_legged("go1")


def balance(robot, forces, wrench):
    feet = robot.feet(robot.home)
    total = np.concatenate((np.cross(feet, forces).sum(axis=0), forces.sum(axis=0)))
    return total + wrench


def searched(robot, wrench, stance, smallest):
    """Find the forces of standing legs by sequential quadratic programming, and their cost."""
    feet, J = robot.feet(robot.home)[stance], robot.foot_jacobians(robot.home)[stance]
    effort = robot.effort.reshape(-1, 3)[stance]

    def torques(x):
        return np.einsum("kij,ki->kj", J, x.reshape(-1, 3)) / effort

    def wrench_left(x):
        F = x.reshape(-1, 3)
        return np.concatenate((np.cross(feet, F).sum(axis=0), F.sum(axis=0))) + wrench

    def cones(x):
        F = x.reshape(-1, 3)
        return MU * F[:, 2] - np.hypot(F[:, 0], F[:, 1])

    def cost(x):
        return (x @ x) / 1e3 if smallest == "forces" else (torques(x) ** 2).sum()

    found = minimize(
        cost,
        np.tile([1.0, 1.0, -wrench[5] / len(stance)], len(stance)),
        method="SLSQP",
        constraints=[
            {"type": "eq", "fun": wrench_left},
            {"type": "ineq", "fun": cones},
            {"type": "ineq", "fun": lambda x: 1.0 - torques(x).ravel()},
            {"type": "ineq", "fun": lambda x: 1.0 + torques(x).ravel()},
        ],
        options={"maxiter": 500, "ftol": 1e-14},
    )
    assert found.success, found.message
    return found.x.reshape(-1, 3), cost


@pytest.mark.parametrize("smallest", ["forces", "torques"])
@pytest.mark.parametrize(
    ("stance", "wrench"),
    [
        (None, [0.0, 0.0, 0.0, 0.0, 0.0, -110.0]),
        (None, [2.0, -3.0, 1.0, 20.0, 15.0, -110.0]),
        (None, [0.0, 0.0, 3.0, 50.0, 0.0, -110.0]),
        # Joints at their efforts.
        (None, [0.0, 30.0, 0.0, 0.0, 0.0, -800.0]),
        (["FL", "RL", "RR"], [-4.0, -6.0, 0.0, 10.0, -5.0, -110.0]),
    ],
)
def test_forces_are_the_smallest_of_a_general_search(robot, stance, wrench, smallest):
    found = foot_forces(robot, robot.home, wrench, stance=stance, friction=MU, smallest=smallest)
    assert np.abs(balance(robot, found.forces, wrench)).max() < 1e-8 * np.abs(wrench).max()
    assert found.used_friction.max() <= 1.0 and found.used_effort.max() <= 1.0 + 1e-7
    J = robot.foot_jacobians(robot.home)
    np.testing.assert_allclose(found.torques, -np.einsum("kij,ki->kj", J, found.forces).ravel())
    standing = list(robot.standing(stance))
    best, cost = searched(robot, np.array(wrench), standing, smallest)
    np.testing.assert_allclose(found.forces[standing], best, atol=1e-3 * np.abs(best).max())
    assert cost(found.forces[standing].ravel()) <= cost(best.ravel()) * (1.0 + 1e-6)


def test_the_ground_may_slope_and_legs_have_a_weight_of_their_own(robot):
    normal = np.array([0.1, -0.2, 1.0])
    own = np.linspace(-1.0, 1.0, 12)
    wrench = [0.0, 0.0, 0.0, 5.0, 0.0, -100.0]
    found = foot_forces(robot, robot.home, wrench, normals=normal, friction=0.3, torques=own)
    n = normal / np.linalg.norm(normal)
    along = found.forces @ n
    aside = np.linalg.norm(found.forces - np.outer(along, n), axis=1)
    assert (aside <= 0.3 * along * (1.0 + 1e-9)).all()
    np.testing.assert_allclose(found.used_friction, aside / (0.3 * along))
    J = robot.foot_jacobians(robot.home)
    held = own - np.einsum("kij,ki->kj", J, found.forces).ravel()
    np.testing.assert_allclose(found.torques, held)


@pytest.mark.parametrize(
    ("stance", "wrench", "feet"),
    [
        # Pushed aside beyond friction, tipped over, lifted, on two feet, too heavy for the joints.
        (None, [0.0, 0.0, 0.0, 90.0, 0.0, -110.0], "FL, FR, RL, RR"),
        (None, [40.0, 0.0, 0.0, 0.0, 0.0, -110.0], "FL, FR, RL, RR"),
        (None, [0.0, 0.0, 0.0, 0.0, 0.0, 10.0], "FL, FR, RL, RR"),
        (["FL", "RR"], [0.0, 2.0, 0.0, 0.0, 0.0, -110.0], "FL, RR"),
        (None, [0.0, 0.0, 0.0, 0.0, 0.0, -9e3], "FL, FR, RL, RR"),
    ],
)
def test_the_missing_wrench_is_what_helps(robot, stance, wrench, feet):
    with pytest.raises(MissingSupportError, match=f"feet {feet} cannot carry the load") as caught:
        foot_forces(robot, robot.home, wrench, stance=stance)
    missing = np.array(caught.value.missing)
    shown = re.search(r"force \[(.*?)\] N", str(caught.value)).group(1)
    np.testing.assert_allclose([float(x) for x in shown.split(",")], missing[3:], rtol=1e-3)
    # With it, and a little towards what is easy, the feet do; with a little less they do not.
    with pytest.raises(MissingSupportError):
        foot_forces(robot, robot.home, np.array(wrench) + 0.99 * missing, stance=stance)
    if stance is None:
        helped = 0.999 * (np.array(wrench) + missing) + 0.001 * EASY
        found = foot_forces(robot, robot.home, helped)
        assert np.abs(balance(robot, found.forces, helped)).max() < 1e-5
    else:
        # Two points carry no moment about the line between them.
        one, other = robot.feet(robot.home)[[0, 3]]
        helped = np.array(wrench) + missing
        about = helped[:3] - np.cross(one, helped[3:])
        assert abs(about @ (other - one)) < 1e-7 * np.abs(wrench).max()


def test_feet_in_the_air_and_wrong_requests(robot):
    load = [0.0, 0.0, 0.0, 0.0, 0.0, -110.0]
    with pytest.raises(MissingSupportError, match="with no foot on the ground") as caught:
        foot_forces(robot, robot.home, load, stance=[])
    assert caught.value.missing == (0.0, 0.0, 0.0, 0.0, 0.0, 110.0)
    heavy = np.zeros(12)
    heavy[3] = 40.0
    with pytest.raises(LimitExceededError, match="effort of joint 'FR_hip'"):
        foot_forces(robot, robot.home, load, stance=["FL", "RL", "RR"], torques=heavy)
    for options, text in (
        ({"friction": -0.1}, "friction"),
        ({"normals": 0.0 * UP}, "normals"),
        ({"smallest": "power"}, "smallest"),
        ({"stance": ["XX"]}, "leg"),
    ):
        with pytest.raises(BadValueError, match=text):
            foot_forces(robot, robot.home, load, **options)
    with pytest.raises(BadValueError, match="posture of leg 'FL'"):
        foot_forces(robot, np.zeros(12), load, smallest="torques")
    with pytest.raises(WrongSizeError, match="wrench"):
        foot_forces(robot, robot.home, load[:3])
    found = foot_forces(robot, robot.home, load, normals=1e300 * UP)
    np.testing.assert_allclose(found.forces, foot_forces(robot, robot.home, load).forces)
