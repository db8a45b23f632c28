"""Simulation: energy, limits, events, and motions that run away."""

import dataclasses

import numpy as np
import pytest

from robomech_ros.dynamics import inverse_dynamics, simulate
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots import Body, Drive, chain_from_dh, load_robot

ARM = load_robot("planar3r")
DOWN = {"gravity": [0, -9.81, 0]}
START = ([0.3, -0.5, 0.4], [0.0, 0.0, 0.0])
PENDULUM = chain_from_dh(
    [1.0], [0.0], [0.0], bodies=[Body(1.0, [0, 0, 0], np.zeros((3, 3)))], limits=[(-1.8, 2.0)]
)


def test_an_arm_that_swings_freely_keeps_its_energy():
    found = simulate(ARM, *START, None, 10.0, rtol=1e-12, atol=1e-13, **DOWN)
    assert found.reason == "finished" and found.t[-1] == 10.0
    assert np.ptp(found.kinetic) > 10.0
    assert found.drift < 1e-8
    assert np.abs(found.kinetic + found.potential - found.potential[0]).max() < 1e-8


@pytest.mark.slow
def test_the_energy_balance_with_friction_is_closed():
    rough = dataclasses.replace(ARM, drives=(Drive(0.5, 0.8), Drive(0.2, 0.3), Drive(0.1, 0.1)))

    def torque(t, q, qd):
        return np.array([9.0 + 3.0 * np.sin(t), 2.0 * np.cos(t), np.sin(3.0 * t)])

    found = simulate(
        rough,
        *START,
        torque,
        10.0,
        tip_wrench=[0, 0, 0.3, 1.0, -1.0, 0],
        rest_rate=0.1,
        rtol=1e-12,
        **DOWN,
    )
    assert found.reason == "finished"
    assert found.heat[-1] > 1.0 and abs(found.work[-1]) > 1.0
    assert (np.diff(found.heat) >= -1e-12).all()
    assert found.drift < 1e-9


def test_the_pendulum_has_its_period():
    found = simulate(PENDULUM, [-np.pi / 2 + 1e-4], [0.0], None, 3.0, times=[0, 1.0, 2.0], **DOWN)
    exact = -np.pi / 2 + 1e-4 * np.cos(np.sqrt(9.81) * found.t)
    np.testing.assert_allclose(found.q[:, 0], exact, atol=1e-10)
    np.testing.assert_array_equal(found.t, [0, 1.0, 2.0])


@pytest.mark.parametrize("method", ["RK45", "LSODA", "Radau", "midpoint"])
def test_methods_agree(method):
    reference = simulate(ARM, *START, None, 0.5, **DOWN)
    found = simulate(ARM, *START, None, 0.5, method=method, rtol=1e-9, atol=1e-11, **DOWN)
    assert found.reason == "finished"
    error = {"midpoint": 1e-4}.get(method, 1e-6)
    np.testing.assert_allclose(found.q[-1], reference.q[-1], atol=error)


def test_the_midpoint_rule_does_not_drift():
    swing = {"method": "midpoint", "step": 0.02, **DOWN}
    short = simulate(PENDULUM, [-0.5], [0.0], None, 1.5, **swing)
    long = simulate(PENDULUM, [-0.5], [0.0], None, 12.0, **swing)
    assert 0.0 < long.drift < 1.05 * short.drift


def test_inverse_dynamics_of_what_is_simulated():
    def torque(t, q, qd):
        return np.array([1.0, -0.5, 0.2]) * np.cos(t)

    times = 0.5 + 1e-4 * np.arange(-1, 2)
    found = simulate(ARM, *START, torque, 1.0, times=times, **DOWN)
    qdd = (found.qd[2] - found.qd[0]) / 2e-4
    back = inverse_dynamics(ARM, found.q[1], found.qd[1], qdd, **DOWN)
    np.testing.assert_allclose(back, torque(0.5, None, None), atol=1e-4)


def test_limits_end_or_bounce():
    falling = (PENDULUM, [-1.6], [-1.0], None, 5.0)
    ended = simulate(*falling, at_limits="end", **DOWN)
    assert "joint 'joint_1' came to its lower limit at 0." in ended.reason
    assert ended.q[-1, 0] == pytest.approx(-1.8, abs=1e-9)
    bouncing = simulate(*falling, at_limits="bounce", restitution=1.0, **DOWN)
    assert bouncing.reason == "finished"
    assert bouncing.q.min() > -1.8 - 1e-9 and bouncing.drift < 1e-8
    lossy = simulate(*falling, at_limits="bounce", restitution=0.5, **DOWN)
    assert lossy.q.min() > -1.8 - 1e-9
    assert lossy.heat[-1] > 0.01 and lossy.drift < 1e-8
    beyond = simulate(*falling, **DOWN)
    assert beyond.q.min() < -1.8


def test_events_are_noted_and_may_end_it():
    def bottom(t, q, qd):
        return q[0] + np.pi / 2

    start = (PENDULUM, [-np.pi / 2 + 1e-3], [0.0], None, 3.0)
    found = simulate(*start, events=[bottom], **DOWN)
    quarter = np.pi / 2 / np.sqrt(9.81)
    times = [t for t, number in found.events if number == 0]
    np.testing.assert_allclose(times, quarter * np.array([1, 3, 5]), rtol=1e-6)
    bottom.terminal = True
    found = simulate(*start, events=[bottom], **DOWN)
    assert found.reason.startswith("event 0 at 0.50") and len(found.events) == 1

    def before(t, q, qd):
        return q[0] + np.pi / 2 - 1e-6

    bottom.terminal = False
    found = simulate(*start, events=[bottom, before], **DOWN)
    assert [number for _, number in found.events[:2]] == [1, 0]
    assert np.diff([t for t, _ in found.events]).min() >= 0.0


def test_a_motion_that_runs_away_is_stopped_with_its_state():
    for torque in (lambda t, q, qd: 1e9 * qd + 1, lambda t, q, qd: qd * np.exp(50 * t) * 1e6 + 1):
        found = simulate(ARM, *START, torque, 10.0)
        assert found.reason.startswith(("the motion ran away", "the integration failed"))
        assert np.isfinite(found.q).all() and len(found.t) >= 1 and found.t[-1] < 10.0

    def breaks_out(t, q, qd):
        return 1e200 * np.sin(t) * (qd + 1.0)

    for method in ("Radau", "BDF", "LSODA", "RK45"):
        found = simulate(ARM, *START, breaks_out, 1.0, method=method)
        assert found.reason.startswith("the motion ran away") and len(found.t) >= 1

    def breaks(t, q, qd):
        return np.full(3, np.nan if t > 0.1 else 0.0)

    found = simulate(ARM, *START, breaks, 10.0)
    assert "the torque at 0.1" in found.reason and "not finite" in found.reason
    assert 0.0 < found.t[-1] <= 0.1


def test_what_is_refused():
    for name, value in (
        ("method", "euler"),
        ("at_limits", "stop"),
        ("restitution", 2.0),
        ("rtol", 0.0),
        ("step", -1.0),
        ("rest_rate", np.inf),
        ("times", [0.5, 0.2]),
        ("events", [3]),
        ("gravity", "down"),
    ):
        with pytest.raises(BadValueError, match=name.replace("events", "one of events")):
            simulate(ARM, *START, None, 1.0, **{name: value})
    with pytest.raises(BadValueError, match="duration"):
        simulate(ARM, *START, None, 0.0)
    with pytest.raises(WrongSizeError, match="torque"):
        simulate(ARM, *START, lambda t, q, qd: np.zeros(2), 1.0)
    with pytest.raises(WrongSizeError, match="q0"):
        simulate(ARM, [0.0] * 2, [0.0] * 3, None, 1.0)
    with pytest.raises(NonFiniteError, match="qd0 of joint 'joint_3'"):
        simulate(ARM, [0.0] * 3, [0.0, 0.0, np.nan], None, 1.0)
    with pytest.raises(BadValueError, match="q0 .*within the position limits"):
        simulate(ARM, [4.0, 0, 0], [0.0] * 3, None, 1.0, at_limits="end")
