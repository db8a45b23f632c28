"""Rejected requests of the dynamics, and their error messages."""

import dataclasses

import numpy as np
import pytest

from robomech_ros.dynamics import (
    bias_torque,
    coriolis_matrix,
    forward_dynamics,
    gravity_torque,
    inverse_dynamics,
    mass_matrix,
    with_payload,
)
from robomech_ros.errors import BadValueError, MissingInertiaError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import Body, Drive, chain_from_dh, load_robot

Z6 = np.zeros(6)


def test_missing_inertias_are_named():
    chain = chain_from_dh([1, 1], [0, 0], [0, 0], bodies=[None, Body(1, [0, 0, 0], np.eye(3))])
    with pytest.raises(MissingInertiaError, match="which joints joint_1 move"):
        mass_matrix(chain, [0, 0])


@pytest.mark.parametrize(
    ("mass", "moments", "text"),
    [
        (-1.0, (1, 1, 1), "its mass is -1 kg, expected a positive number"),
        (1.0, (1, 1, -1), "expected no negative one"),
        (1.0, (1, 1, 3), "expected the greatest to be at most the sum of the others"),
    ],
)
def test_impossible_bodies_are_refused_with_the_reason(mass, moments, text):
    chain = chain_from_dh([1], [0], [0], bodies=[Body(mass, [0, 0, 0], np.diag(moments))])
    with pytest.raises(BadValueError, match=f"body of link_1 and tool0 .*{text}"):
        gravity_torque(chain, [0.0])


def test_shapes_and_numbers():
    chain = load_robot("puma560")
    with pytest.raises(WrongSizeError, match=r"qd .*\(6,\), that of q"):
        inverse_dynamics(chain, Z6, np.zeros((2, 6)), Z6)
    with pytest.raises(WrongSizeError, match=r"tau .*waist, shoulder"):
        forward_dynamics(chain, Z6, Z6, np.zeros(5))
    with pytest.raises(NonFiniteError, match="qd of joint 'elbow' is nan"):
        coriolis_matrix(chain, Z6, [0, 0, np.nan, 0, 0, 0])
    with pytest.raises(NonFiniteError, match="q of joint 'elbow' in row 1 is inf"):
        mass_matrix(chain, [Z6, [0, 0, np.inf, 0, 0, 0]])
    with pytest.raises(NonFiniteError, match="tau of joint 'waist'"):
        forward_dynamics(chain, Z6, Z6, [np.nan, 0, 0, 0, 0, 0])
    with pytest.raises(WrongSizeError, match=r"tip_wrench .*\(6,\) or \(2, 6\)"):
        bias_torque(chain, np.zeros((2, 6)), np.zeros((2, 6)), tip_wrench=np.zeros((3, 6)))
    with pytest.raises(WrongSizeError, match="gravity"):
        gravity_torque(chain, Z6, gravity=[0, -9.81])
    with pytest.raises(NonFiniteError, match="gravity"):
        gravity_torque(chain, Z6, gravity=[0, 0, np.nan])
    with pytest.raises(BadValueError, match="gravity"):
        gravity_torque(chain, Z6, gravity=None)
    with pytest.raises(BadValueError, match="method .*articulated-body, cholesky"):
        forward_dynamics(chain, Z6, Z6, Z6, method="lu")
    with pytest.raises(BadValueError, match="chain"):
        mass_matrix("puma560", Z6)


@pytest.mark.parametrize("value", [1e200, -1e308])
def test_huge_rates_and_torques_give_a_number_or_a_refusal(value):
    chain = load_robot("puma560")
    with pytest.raises(BadValueError, match="largest of qd .*values with a finite result"):
        inverse_dynamics(chain, Z6, np.full(6, value), Z6)
    with pytest.raises(BadValueError, match="largest of qd"):
        forward_dynamics(chain, Z6, np.full(6, value), Z6)
    assert np.isfinite(forward_dynamics(chain, Z6, Z6, np.full(6, 1e200))).all()
    assert np.isfinite(mass_matrix(chain, np.full(6, value))).all()


def test_a_number_that_no_entry_of_the_matrix_depends_on_is_looked_at_all_the_same():
    slide = chain_from_dh(
        [0.0], [0.0], [0.0], types="P", bodies=[Body(2.0, [0, 0, 0], np.zeros((3, 3)))]
    )
    assert mass_matrix(slide, [0.3]) == [[2.0]]
    with pytest.raises(NonFiniteError, match="q of joint 'joint_1'"):
        mass_matrix(slide, [np.nan])


def test_a_motion_that_nothing_resists():
    point = Body(1.0, [0, 0, 0.2], np.zeros((3, 3)))
    spindle = chain_from_dh([0.0], [0.0], [0.0], bodies=[point])
    for method in ("articulated-body", "cholesky"):
        with pytest.raises(BadValueError, match="resist every motion"):
            forward_dynamics(spindle, [0.0], [0.0], [1.0], method=method)
    driven = dataclasses.replace(spindle, drives=(Drive(rotor_inertia=1e-4, gear_ratio=-100.0),))
    np.testing.assert_allclose(forward_dynamics(driven, [0.0], [0.0], [2.0]), [2.0])


def test_payloads():
    chain, load = load_robot("puma560"), Body(2.0, [0, 0, 0.1], 0.01 * np.eye(3))
    heavier = with_payload(chain, load)
    difference = gravity_torque(heavier, Z6) - gravity_torque(chain, Z6)
    weight = {"gravity": [0, 0, 0], "tip_wrench": [0, 0, 0, 0, 0, -2.0 * 9.81]}
    # At q = 0 the tip's z axis is vertical, so that the load hangs on a line through the tip.
    np.testing.assert_allclose(difference, gravity_torque(chain, Z6, **weight), atol=1e-12)
    # An arm whose tip is turned away from its last joint, with a load beside the axis.
    arm, q = load_robot("crx10ia"), np.linspace(0.2, 1.2, 6)
    beside = with_payload(arm, Body(2.0, [0.2, 0.1, 0.1], 0.01 * np.eye(3)))
    force, T = np.array([0.0, 0.0, -2.0 * 9.81]), forward_kinematics(arm, q)
    moment = np.cross(T[:3, :3] @ [0.2, 0.1, 0.1], force)
    weight = {"gravity": [0, 0, 0], "tip_wrench": [*moment, *force]}
    difference = gravity_torque(beside, q) - gravity_torque(arm, q)
    np.testing.assert_allclose(difference, gravity_torque(arm, q, **weight), atol=1e-12)
    with pytest.raises(BadValueError, match="payload .*its mass is -1 kg"):
        with_payload(chain, Body(-1.0, [0, 0, 0], np.eye(3)))
    with pytest.raises(BadValueError, match="payload"):
        with_payload(chain, 2.0)
    with pytest.raises(BadValueError, match="at least one, to carry a payload"):
        with_payload(chain.with_tip("base_link"), load)
