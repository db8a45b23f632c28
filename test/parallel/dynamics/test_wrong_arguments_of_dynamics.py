"""Whatever the dynamics of a parallel robot are given, they answer or raise an error of ours."""

import numpy as np
import pytest
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.dynamics import simulate, torque_summary
from robomech_ros.parallel import LinkBodies, ParallelDynamics, load_parallel
from robomech_ros.robots import Body

VALUES = (
    *WRONG_VALUES,
    [np.nan] * 6,
    [np.inf] * 6,
    [1e300] * 6,
    [1e30] * 6,
    [1e300] * 36,
    [0.0] * 36,
    [0.1] * 36,
    np.empty((0, 6)),
    np.empty((0, 36)),
    np.zeros(6, complex),
    ["0"] * 6,
)


def calls():
    """Every method, one argument at a time."""
    mechanism = load_parallel("hexapod").mechanism
    robot, q, u = ParallelDynamics(mechanism), mechanism.home(), [0.1] * 6
    body = Body(1.0, np.zeros(3), np.eye(3))
    around = {"gravity": [0.0, 0.0, -9.81], "tip_wrench": [1.0] * 6}
    found = with_options(robot.inverse, q=q, rates=u, accelerations=u, **around)
    found |= with_options(robot.forward, q=q, rates=u, efforts=u, **around)
    found |= with_options(robot.reactions, q=q, rates=u, accelerations=u, **around)
    for method in (robot.coriolis_matrix, robot.friction, robot.kinetic_energy, robot.bodies):
        found |= with_options(method, q=q, rates=u)
    for method in (robot.joint_rates, robot.tip_twist):
        found |= with_options(method, q=q, rates=u)
    for method in (robot.mass_matrix, robot.complement, robot.checked_posture):
        found |= with_options(method, q=q)
    found |= with_options(robot.gravity, q=q, gravity=[0.0] * 3)
    found |= with_options(robot.potential_energy, q=q, gravity=[0.0] * 3)
    found |= with_options(robot.with_payload, payload=body)
    found |= with_options(LinkBodies, bodies={"platform": body})
    found |= with_options(ParallelDynamics, mechanism=mechanism)
    rows = {"times": [0.0], "q": [q], "qd": [u], "qdd": [u]}
    found |= with_options(torque_summary, chain=robot, **rows)
    run = {"q0": q, "qd0": u, "torque": None, "duration": 1e-3, "method": "RK23", "rtol": 1e-3}
    run_of_robot = with_options(simulate, chain=robot, **run)
    for name in ("chain", "q0", "qd0", "torque", "gravity", "tip_wrench", "at_limits"):
        found[f"simulate.{name}"] = run_of_robot[f"simulate.{name}"]
    return found


CALLS = calls()


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    answered_or_refused(CALLS[name], VALUES)
