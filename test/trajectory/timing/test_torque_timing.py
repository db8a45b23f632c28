"""Time-optimal motions along paths within the torques of a robot's drives."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.optimize import brentq

from robomech_ros.dynamics import friction_torque, inverse_dynamics, with_payload
from robomech_ros.errors import (
    BadValueError,
    MissingInertiaError,
    MissingLimitsError,
    NonFiniteError,
    WrongSizeError,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import Body, Drive, chain_from_dh, load_robot
from robomech_ros.trajectory import (
    Limits,
    PiecewisePolynomial,
    SerialArm,
    spline_through,
    straight_path,
    time_optimal,
    torque_limited,
    track_path,
)

PUMA = load_robot("puma560")
SPEEDS = Limits(PUMA.joint_names, velocity=PUMA.velocity)
EFFORT = {"effort": PUMA.effort}
MODEL = partial(inverse_dynamics, PUMA)
FRICTION = partial(friction_torque, PUMA)
# All joints turn back on the way.
POINTS = [
    [0.0, 0.8, -0.6, 0.0, 0.5, 0.0],
    [0.9, 0.2, 0.3, -0.7, -0.4, 0.8],
    [-0.4, 1.0, -0.9, 0.6, 0.3, -0.9],
    [0.3, 0.4, 0.1, -0.2, 0.8, 0.4],
]
PATH = spline_through(POINTS, times=[0.0, 0.3, 0.7, 1.0], ends="natural").pieces


def loads(motion, model, effort, friction=None, velocity=None, count=20_000):
    """The largest torque, and the largest torque or rate, in parts of the limits at instants."""
    at = motion.sample(np.linspace(0.0, motion.duration, count)[1:-1])
    tau = model(at.position, at.velocity, at.acceleration)
    tau = tau if friction is None else tau + friction(at.velocity)
    parts = (np.abs(tau) / effort).max(axis=1)
    rates = 0.0 if velocity is None else (np.abs(at.velocity) / velocity).max(axis=1)
    return parts, np.maximum(parts, rates)


@pytest.mark.parametrize("friction", [None, FRICTION])
def test_a_robot_is_at_a_limit_nearly_all_the_time(friction):
    motion = torque_limited(PATH, SPEEDS, MODEL, friction=friction, **EFFORT)
    torques, most = loads(motion, MODEL, PUMA.effort, friction, PUMA.velocity)
    assert torques.max() <= 1.0 + 1e-6 and most.max() <= 1.0 + 1e-6
    assert torques.max() > 1.0 - 1e-6
    assert np.quantile(most, 0.1) > 0.999 and np.quantile(most, 0.01) > 0.98


@pytest.mark.parametrize("seed", range(3))
def test_pinocchio_finds_the_same_torques_at_their_limits(seed, pinocchio_model):
    import pinocchio

    chain, model = load_robot("ur5e"), pinocchio_model("ur5e")
    data, effort = model.createData(), 0.6 * chain.effort
    points = np.random.default_rng(seed).uniform(-1.5, 1.5, (4, 6))
    path = spline_through(points, times=[0.0, 1.0, 2.0, 3.0], ends="natural").pieces
    speeds = Limits(chain.joint_names, velocity=chain.velocity)
    motion = torque_limited(path, speeds, partial(inverse_dynamics, chain), effort=effort)

    def theirs(q, qd, qdd):
        rows = zip(q, qd, qdd, strict=True)
        return np.array([pinocchio.rnea(model, data, *row) for row in rows])

    torques, most = loads(motion, theirs, effort, None, chain.velocity)
    assert 1.0 - 1e-6 < torques.max() <= 1.0 + 1e-6 and most.max() <= 1.0 + 1e-6
    assert np.quantile(most, 0.1) > 0.999


def test_the_drives_of_a_chain_are_its_own_limits_beside_those_of_acceleration():
    motion = torque_limited(PATH, PUMA, MODEL)
    torques, _ = loads(motion, MODEL, PUMA.effort)
    assert torques.max() <= 1.0 + 1e-6
    assert motion.duration >= time_optimal(PATH, PUMA).duration
    assert motion.duration > torque_limited(PATH, SPEEDS, MODEL, **EFFORT).duration


def test_a_payload_takes_longer():
    loaded = with_payload(PUMA, Body(2.0, [0.0, 0.0, 0.1], 1e-3 * np.eye(3)))
    model = partial(inverse_dynamics, loaded)
    motion = torque_limited(PATH, SPEEDS, model, **EFFORT)
    assert motion.duration > torque_limited(PATH, SPEEDS, MODEL, **EFFORT).duration
    assert loads(motion, model, PUMA.effort)[0].max() <= 1.0 + 1e-6


def test_along_a_straight_line_of_the_tip():
    start = forward_kinematics(PUMA, POINTS[0])
    end = start.copy()
    end[:3, 3] += [0.1, 0.3, -0.2]
    arm = SerialArm(
        partial(forward_kinematics, PUMA), lambda T, near: None, partial(jacobian, PUMA)
    )
    tracked = track_path(straight_path([start, end]), arm, POINTS[0])
    motion = torque_limited(tracked.path.pieces, SPEEDS, MODEL, friction=FRICTION, **EFFORT)
    _, most = loads(motion, MODEL, PUMA.effort, FRICTION, PUMA.velocity)
    assert most.max() <= 1.0 + 1e-6 and np.quantile(most, 0.1) > 0.999
    np.testing.assert_allclose(
        motion.sample(motion.duration).position,
        tracked.path.pieces.sample(tracked.path.length).position,
        atol=1e-12,
    )


def slide(**drive):
    """A mass of 1 kg on a horizontal slide with a drive of 1 N."""
    return chain_from_dh(
        [0.0], [0.0], [0.0], types="P", bodies=[Body(1.0, [0.0] * 3, 1e-3 * np.eye(3))],
        drives=[Drive(**drive)], limits={"velocity": [1e3], "effort": [1.0]},
    )  # fmt: skip


def along(length, chain):
    path = PiecewisePolynomial(np.array([0.0, 1.0]), np.array([[[0.0]], [[length]]]))
    model = partial(inverse_dynamics, chain, gravity=[0.0, 0.0, 0.0])
    return torque_limited(path, chain, model, friction=partial(friction_torque, chain))


@pytest.mark.parametrize(("viscous", "coulomb"), [(0.0, 0.5), (1.0, 0.0), (4.0, 0.3)])
def test_a_mass_with_friction_moves_as_its_equation_says(viscous, coulomb):
    """``v' = +-1 - coulomb - viscous v``; at 4 N s/m the mass soon has its final speed."""
    push, brake, length = 1.0 - coulomb, 1.0 + coulomb, 5.0

    def stopped(t):
        if viscous == 0.0:
            v, x = push * t, 0.5 * push * t**2
            return x + 0.5 * v**2 / brake, t + v / brake
        final, halt = push / viscous, brake / viscous
        v = final * -np.expm1(-viscous * t)
        x = final * t - v / viscous
        to_rest = np.log1p(v / halt) / viscous
        return x + v / viscous - halt * to_rest, t + to_rest

    pushed = brentq(lambda t: stopped(t)[0] - length, 1e-3, 100.0, xtol=1e-13)
    motion = along(length, slide(viscous=viscous, coulomb=coulomb))
    assert motion.duration == pytest.approx(stopped(pushed)[1], rel=1e-3)
    assert motion.duration > stopped(pushed)[1] * (1.0 - 1e-6)


def test_static_friction_is_kept_in_as_well():
    chain = slide(coulomb=0.3, static=0.8, stribeck_velocity=0.1)
    motion = along(1.0, chain)
    model = partial(inverse_dynamics, chain, gravity=[0.0] * 3)
    torques, _ = loads(motion, model, chain.effort, partial(friction_torque, chain))
    assert torques.max() <= 1.0 + 1e-6 and np.quantile(torques, 0.05) > 0.99


def test_joints_without_effort_limits_are_not_limited():
    effort = np.array([np.inf, np.inf, np.nan, np.inf, np.inf, PUMA.effort[5] / 20.0])
    motion = torque_limited(PATH, SPEEDS, MODEL, effort=effort)
    torques, most = loads(motion, MODEL, np.nan_to_num(effort, nan=np.inf), None, PUMA.velocity)
    assert torques.max() <= 1.0 + 1e-6 and np.quantile(most, 0.2) > 0.999


def test_what_is_refused():
    with pytest.raises(MissingLimitsError, match="no effort limit for joints waist"):
        torque_limited(PATH, SPEEDS, MODEL)
    with pytest.raises(MissingLimitsError, match="no velocity limit"):
        torque_limited(PATH, Limits(PUMA.joint_names), MODEL, **EFFORT)
    with pytest.raises(BadValueError, match="torque limits .* these allow none|path speed"):
        torque_limited(PATH, SPEEDS, MODEL, effort=0.1 * PUMA.effort)
    with pytest.raises(MissingInertiaError, match="waist"):
        torque_limited(PATH, PUMA, partial(inverse_dynamics, replace(PUMA, bodies=())))
    with pytest.raises(WrongSizeError, match="effort"):
        torque_limited(PATH, SPEEDS, MODEL, effort=[1.0])
    for effort in (0.0, -1.0):
        with pytest.raises(BadValueError, match="effort of joint 'waist'"):
            torque_limited(PATH, SPEEDS, MODEL, effort=np.full(6, effort))
    for wrong, error in (
        (lambda *q: np.zeros(6), WrongSizeError),
        (lambda *q: np.full_like(q[0], np.nan), NonFiniteError),
        (lambda *q: "torques", BadValueError),
        (None, BadValueError),
    ):
        with pytest.raises(error, match="inverse_dynamics"):
            torque_limited(PATH, SPEEDS, wrong, **EFFORT)
        if wrong is not None:
            with pytest.raises(error, match="friction"):
                torque_limited(PATH, SPEEDS, MODEL, friction=wrong, **EFFORT)
    with pytest.raises(WrongSizeError, match="joints of the path"):
        torque_limited(PATH, Limits(["a"], velocity=1.0), MODEL, effort=[1.0])
