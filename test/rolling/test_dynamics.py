"""Dynamics of rolling robots: the book's figures, Lagrange's equations with multipliers, energy."""

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
import sympy

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.rolling import (
    PlatformBody,
    RollingBase,
    RollingDynamics,
    Wheel,
    WheelBody,
    ackermann,
    differential_drive,
    mecanum,
    omnidirectional,
    rolling_robot,
    simulate_rolling,
    steering_along,
    swerve,
    tricycle,
)

GOLDEN = Path(__file__).parents[1] / "data" / "golden"
BOOK = json.loads((GOLDEN / "dynamics_rolling.json").read_text(encoding="utf-8"))


def test_two_driven_wheels_of_the_book():
    case = BOOK["differential"]
    wheel = WheelBody(
        mass=case["m_wheel"], spin=case["I_wheel_spin"], turn=case["I_wheel_vertical"]
    )
    platform = PlatformBody(
        mass=case["m_platform"], inertia=case["Ic"], centre=[case["com_forward"], 0.0]
    )
    base = differential_drive(case["r"], case["track"])
    moving = RollingDynamics(base, platform, [wheel, wheel])
    twist, _ = base.body_twist(case["thd_RL"][::-1])
    inertia, coupling = moving.drive_model(twist)
    assert np.abs(inertia - case["I"]).max() < 1e-10
    assert np.abs(coupling[::-1] - case["C_thd"]).max() < 1e-10
    found = base.rate_rows() @ moving.forward(twist, case["tau_RL"][::-1])
    assert np.abs(found[::-1] - case["thdd"]).max() < 1e-10


def test_three_omnidirectional_wheels_of_the_book():
    case = BOOK["omni3"]
    rho, wheels = 0.25, []
    for angle in np.radians([0.0, 120.0, 240.0]):
        place = rho * np.array([math.cos(angle), math.sin(angle)])
        heading = angle + 0.5 * math.pi
        wheels.append(Wheel(kind="omni", position=place, radius=0.05, heading=heading))
    base = RollingBase(wheels)
    # Its wheels have no mass of their own: they turn about their axles without the base.
    platform = PlatformBody(mass=case["m_total"], inertia=case["I_total"])
    moving = RollingDynamics(base, platform, [WheelBody(spin=case["I_wheel_spin"])] * 3)
    twist, slip = base.body_twist(case["thd"])
    assert slip < 1e-12
    assert np.abs(twist - case["twist_body"]).max() < 1e-12
    inertia, coupling = moving.drive_model(twist)
    assert np.abs(inertia - case["I"]).max() < 1e-10
    assert np.abs(coupling - case["C_thd"]).max() < 1e-10
    assert abs(np.dot(case["thd"], coupling)) < 1e-12
    found = base.rate_rows() @ moving.forward(twist, case["tau"])
    assert np.abs(found - case["thdd"]).max() < 1e-10


def heavy(base, rng):
    """Bodies of random masses, all of them off the centre."""
    bodies = [
        WheelBody(**dict(zip(
            ("mass", "spin", "turn", "bracket_mass", "bracket_inertia", "bracket_centre"),
            rng.uniform(0.1, 1.0, 6), strict=True)))
        for _ in base.wheels
    ]  # fmt: skip
    platform = PlatformBody(mass=5.0, inertia=0.7, centre=rng.uniform(-0.3, 0.3, 2))
    return RollingDynamics(base, platform, bodies)


def caster(x, y, heading=0.0):
    return Wheel(
        kind="caster", position=(x, y), radius=0.06, trail=0.09, heading=heading, name=f"at {x} {y}"
    )


BASES = {
    "two wheels, a caster": differential_drive(0.1, 0.4, casters=[caster(-0.4, 0.1)]),
    "two wheels, two casters": differential_drive(
        0.1, 0.4, casters=[caster(-0.4, 0.1, 0.7), caster(0.3, -0.2)]
    ),
    "three wheels": omnidirectional(3, 0.08, 0.3, offset=0.4),
    "three wheels, a caster": RollingBase(
        [*omnidirectional(3, 0.08, 0.3).wheels, caster(0.1, 0.1)]
    ),
    "four wheels": omnidirectional(4, 0.08, 0.3),
    "four mecanum wheels": mecanum(0.1, 0.5, 0.4, roller=0.6),
}
STEERED = {
    "tricycle": tricycle(0.125, 1.252, 0.8),
    "car with a caster": RollingBase(
        [*ackermann(0.15, 1.2, 0.8, steering_limit=1.5).wheels, caster(0.3, 0.1, 0.4)]
    ),
    "swerve": swerve(0.05, [[0.25, 0.2], [0.2, -0.25], [-0.2, -0.2], [-0.25, 0.2]]),
}


def lagrange(moving):
    """Mass matrix, remaining inertia, constraints and their rates, by coordinates of all bodies.

    Coordinates are x, y, heading, the wheels' angles, the brackets' and the steered wheels'.
    """
    base, casters = moving.base, len(moving.base.casters)
    count = len(base.wheels)
    size = 3 + count + casters + len(base.steered)
    q, v = sympy.symbols(f"q0:{size}"), sympy.symbols(f"v0:{size}")
    here, heading = sympy.Matrix(q[:2]), q[2]

    def turned(angle):
        return sympy.Matrix([sympy.cos(angle), sympy.sin(angle)])

    def across(angle):
        return sympy.Matrix([-sympy.sin(angle), sympy.cos(angle)])

    def at(point):
        x, y = map(float, point)
        return here + x * turned(heading) + y * across(heading)

    def speed(place):
        return place.jacobian(q) * sympy.Matrix(v)

    def energy(mass, place, inertia, turn):
        return mass * speed(place).dot(speed(place)) / 2 + inertia * turn**2 / 2

    platform = moving.platform
    kinetic = energy(platform.mass, at(platform.centre), platform.inertia, v[2])
    rows, axles = [], []
    brackets, steering = iter(range(3 + count, size)), iter(range(3 + count + casters, size))
    for i, (wheel, body) in enumerate(zip(base.wheels, moving.wheels, strict=True)):
        place, angle, turn = at(wheel.position), heading + wheel.heading, v[2]
        if wheel.kind in ("caster", "steered"):
            psi = next(brackets if wheel.kind == "caster" else steering)
            angle, turn = angle + q[psi], turn + v[psi]
            middle = place - body.bracket_centre * turned(angle)
            kinetic += energy(body.bracket_mass, middle, body.bracket_inertia, turn)
            place = place - wheel.trail * turned(angle)
        kinetic += energy(body.mass, place, body.turn, turn) + body.spin * v[3 + i] ** 2 / 2
        slip = speed(place) - wheel.radius * v[3 + i] * turned(angle)
        if wheel.kind == "omni":
            rows.append(slip.dot(turned(angle + wheel.roller)))
        else:
            rows += [slip.dot(turned(angle)), slip.dot(across(angle))]
        if wheel.kind in ("fixed", "steered"):
            (x, y), side = map(float, wheel.position), across(angle - heading)
            axles.append([x * side[1] - y * side[0], *side])
    # Coordination of steered wheels: any three axles meet in one point.
    triples = itertools.combinations(axles if base.steered else [], 3)
    meeting = sympy.Matrix([sympy.Matrix(three).det() for three in triples])
    if meeting:
        rows += list(meeting.jacobian(q) * sympy.Matrix(v))
    momentum = sympy.Matrix([sympy.diff(kinetic, one) for one in v])
    M = momentum.jacobian(v)
    rest = momentum.jacobian(q) * sympy.Matrix(v) - sympy.Matrix([kinetic]).jacobian(q).T
    A = sympy.Matrix(rows).jacobian(v)
    A_rate = (A * sympy.Matrix(v)).jacobian(q) * sympy.Matrix(v)
    return sympy.lambdify([q, v], [M, rest, A, A_rate])


@pytest.mark.parametrize("name", BASES | STEERED)
def test_accelerations_are_those_of_lagrange_with_multipliers(name):
    base, rng = (BASES | STEERED)[name], np.random.default_rng(9)
    moving = heavy(base, rng)
    equations, count = lagrange(moving), len(base.wheels)
    for _ in range(3):
        twist = base.feasible(rng.normal([0.0, 1.0, 0.0], [0.3, 0.3, 1.0]))
        steering = steering_along(base, twist, base.feasible(rng.normal(size=3)))
        psi = rng.uniform(-3.0, 3.0, len(base.casters))
        torques, wrench = rng.normal(size=len(moving.motors)), rng.normal(size=3)
        heading = rng.uniform(-3.0, 3.0)
        c, s = math.cos(heading), math.sin(heading)
        R = np.array([[c, -s], [s, c]])
        q = np.concatenate([[0.3, -0.2, heading], np.zeros(count), psi, steering.angles])
        rolling = base.rolling_rates(twist, steering.angles, brackets=psi)
        rates = [R @ twist[1:], twist[:1], rolling, base.caster_rates(twist, psi), steering.rates]
        v = np.concatenate(rates)
        M, rest, A, A_rate = (np.asarray(one, float) for one in equations(q, v))
        assert np.abs(A @ v).max() < 1e-12
        forces = np.zeros(len(q))
        forces[:2], forces[2] = R @ wrench[1:], wrench[0]
        at = [3 + i for i, wheel in enumerate(base.wheels) if wheel.driven]
        forces[at + list(range(len(q) - len(base.steered), len(q)))] = torques
        known = np.concatenate([forces - rest.ravel(), -A_rate.ravel()])
        zero = np.zeros((len(A), len(A)))
        solved = np.linalg.lstsq(np.block([[M, A.T], [A, zero]]), known, rcond=1e-13)[0]
        body = R.T @ solved[:2]
        expected = np.array([
            solved[2], body[0] + twist[0] * twist[2], body[1] - twist[0] * twist[1],
            *solved[len(q) - len(base.steered) : len(q)],
        ])  # fmt: skip
        found = moving.forward(twist, torques, psi, steering=steering, wrench=wrench)
        assert np.abs(found - expected).max() < 1e-10 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize("name", STEERED)
def test_torques_and_steering_of_a_motion(name):
    """Differences of angles, energy and power; a pivot's own equation gives its torque."""
    base, rng = STEERED[name], np.random.default_rng(12)
    moving = heavy(base, rng)
    for _ in range(5):
        twist = base.feasible(rng.normal([0.0, 1.0, 0.0], [0.3, 0.3, 1.0]))
        acceleration, jerk = (base.feasible([0.3, 2.0, 1.0] * rng.normal(size=3)) for _ in "ab")
        psi, step = rng.uniform(-3.0, 3.0, len(base.casters)), 1e-5
        steering = steering_along(base, twist, acceleration, jerk)

        before, after = (
            steering_along(
                base, twist + h * acceleration, acceleration + h * jerk, near=steering.angles
            )
            for h in (-step, step)
        )
        assert (after.angles - before.angles) / (2 * step) == pytest.approx(steering.rates, 1e-6)
        slope = (after.rates - before.rates) / (2.0 * step)
        assert slope == pytest.approx(steering.accelerations, rel=1e-6, abs=1e-6)
        torques = moving.inverse(twist, acceleration, psi, steering=steering)
        back = moving.forward(twist, torques, psi, steering=steering)
        assert back == pytest.approx(np.append(acceleration, steering.accelerations), abs=1e-9)
        turn = step * base.caster_rates(twist, psi)
        ends = zip((-step, step), (before, after), strict=True)
        gain = [
            moving.kinetic_energy(twist + h * acceleration, psi + h / step * turn, steering=steered)
            for h, steered in ends
        ]
        driven = [wheel.driven for wheel in base.wheels]
        rolling = base.rolling_rates(twist, steering.angles, psi)[driven]
        power = torques @ np.append(rolling, steering.rates)
        assert (gain[1] - gain[0]) / (2.0 * step) == pytest.approx(power, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("name", BASES)
def test_inverse_and_forward_dynamics_belong_together(name):
    base, rng = BASES[name], np.random.default_rng(10)
    moving = heavy(base, rng)
    for _ in range(10):
        twist, acceleration = base.feasible(rng.normal(size=(2, 3)))
        psi, wrench = rng.uniform(-3.0, 3.0, len(base.casters)), rng.normal(size=3)
        torques = moving.inverse(twist, acceleration, psi, wrench=wrench)
        back = moving.forward(twist, torques, psi, wrench=wrench)
        assert np.abs(back - acceleration).max() < 1e-10
        # Of four wheels, torques with the least sum of squares do not work against each other.
        null = np.eye(len(torques)) - moving.drives @ np.linalg.pinv(moving.drives)
        assert np.abs(null @ torques).max() < 1e-10
        # Power: what goes in is what the energy gains.
        bodies = moving.bodies(twist, psi)
        rates = np.linalg.lstsq(moving.free, twist, rcond=None)[0]
        step = 1e-6
        later = base.feasible(twist + step * acceleration)
        earlier = base.feasible(twist - step * acceleration)
        turn = base.caster_rates(twist, psi)
        gain = moving.kinetic_energy(later, psi + step * turn)
        gain -= moving.kinetic_energy(earlier, psi - step * turn)
        power = torques @ (moving.drives @ rates) + wrench @ twist
        assert gain / (2.0 * step) == pytest.approx(power, rel=1e-6, abs=1e-6)
        after, before = (moving.bodies(twist, psi + h * turn) for h in (step, -step))
        rate = (after.generalised_inertia - before.generalised_inertia) / (2.0 * step)
        skew = rate - 2.0 * bodies.coupling
        rounding = 1e-15 * np.abs(bodies.generalised_inertia).max() / step
        assert np.abs(skew + skew.T).max() < 1e-8 * max(1.0, np.abs(skew).max()) + rounding


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two wheels, a caster", "four mecanum wheels", *STEERED])
def test_energy_is_kept_to_1e_8(name):
    base = (BASES | STEERED)[name]
    moving = heavy(base, np.random.default_rng(11))
    twist = base.feasible([0.9, 0.6, -0.3])
    time = 2.0 if base.steered else 10.0
    free = simulate_rolling(moving, twist, None, time, brackets=[1.0] * len(base.casters))
    assert free.drift < 1e-8 * free.kinetic[0]
    assert not free.work.any()

    def torques(t, twist, brackets, steering=None):
        return np.sin(t + np.arange(len(moving.motors)))

    driven = simulate_rolling(moving, twist, torques, 0.3 * time)
    assert driven.drift < 1e-8 * driven.kinetic.max()
    assert np.ptp(driven.work) > 0.05
    if base.steered:
        wanted = base.steering_angles(driven.twist[-1], driven.steering[-1])
        assert driven.steering[-1] == pytest.approx(wanted, abs=1e-8)


def test_the_pose_of_a_run_is_that_of_its_twist():
    """Constant torques on both wheels of a symmetric base drive it along its ray."""
    base = differential_drive(0.1, 0.4)
    moving = RollingDynamics(base, PlatformBody(mass=8.0, inertia=0.3), [WheelBody(mass=1.0)] * 2)
    run = simulate_rolling(moving, np.zeros(3), lambda t, v, b: [0.5, 0.5], 2.0, pose=[1, 2, 0.3])
    way = 0.5 * (2 * 0.5 / 0.1 / 10.0) * 2.0**2
    assert run.pose[-1] == pytest.approx([1 + way * math.cos(0.3), 2 + way * math.sin(0.3), 0.3])


def test_torques_are_shortened_as_a_whole():
    moving = rolling_robot("differential").dynamics
    torques, names = moving.within_limits([5.0, -2.0])
    assert torques == pytest.approx([2.5, -1.0])
    assert names == ("left",)
    assert moving.within_limits([1.0, 2.0])[1] == ()


def test_what_is_no_dynamics_is_refused():
    body, platform = WheelBody(mass=1.0), PlatformBody(mass=1.0, inertia=1.0)
    steered = Wheel(kind="steered", position=[0.0, 0.0], radius=0.05, name="turned")
    wheels = [*omnidirectional(3, 0.1, 0.3).wheels, steered]
    with pytest.raises(BadValueError, match="type of the base is '\\(2,1\\)', expected \\(1,1\\)"):
        RollingDynamics(RollingBase(wheels), platform, [body] * 4)
    with pytest.raises(WrongSizeError, match="wheels has size 1"):
        RollingDynamics(differential_drive(0.1, 0.4), platform, [body])
    with pytest.raises(BadValueError, match="mass is -1.0"):
        WheelBody(mass=-1.0)
    moving = RollingDynamics(differential_drive(0.1, 0.4), platform, [body] * 2)
    with pytest.raises(BadValueError, match="acceleration is .*such as"):
        moving.inverse([0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
    with pytest.raises(BadValueError, match="driven wheels is 4, expected 3"):
        rolling_robot("mecanum").dynamics.drive_model([0.0, 1.0, 0.0])
