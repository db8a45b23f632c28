"""Closed forms of the planar 3-RRR and of rolling robots, equal to the numeric models."""

import numpy as np
import pytest
import sympy

from robomech_ros.dynamics.symbolic import (
    symbolic_omnidirectional,
    symbolic_planar_3rrr,
    symbolic_two_wheels,
)
from robomech_ros.errors import BadValueError
from robomech_ros.parallel import ParallelDynamics, load_parallel
from robomech_ros.rolling import (
    PlatformBody,
    RollingDynamics,
    Wheel,
    WheelBody,
    differential_drive,
    omnidirectional,
)


def relative(one, other):
    return np.abs(np.asarray(one) - other).max() / np.abs(other).max()


@pytest.fixture(scope="module")
def planar():
    return symbolic_planar_3rrr(), symbolic_planar_3rrr().compiled()


def planar_values(case, pose, theta, rates):
    """Values of all symbols; psi are the angles from the elbows to the platform's corners."""
    A, b = np.array(case["A"]), np.array(case["b_platform"])
    x, y, phi = pose
    R = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
    elbows = A + case["l1"] * np.stack((np.cos(theta), np.sin(theta)), axis=1)
    ways = [x, y] + b @ R.T - elbows
    values = {"l_1": case["l1"], "l_2": case["l2"], "phi": phi}
    values |= {"c_1": 0.5 * case["l1"], "c_2": 0.5 * case["l2"], "I_P": case["Ip"]}
    values |= {"m_1": case["m1"], "m_2": case["m2"], "m_P": case["mp"]}
    values |= {"I_1": case["I1"], "I_2": case["I2"]}
    for i in range(3):
        values |= {f"x_{i + 1}": b[i, 0], f"y_{i + 1}": b[i, 1], f"theta_{i + 1}": theta[i]}
        values |= {f"psi_{i + 1}": np.arctan2(*ways[i, ::-1]), f"thetadot_{i + 1}": rates[i]}
    return values


@pytest.mark.slow
def test_golden_planar_3rrr(golden, planar):
    case, (_, evaluate) = golden("dynamics_planar_3rrr"), planar
    rates = np.array(case["thd"])
    inertia, coupling = evaluate(planar_values(case, case["pose"], case["theta"], rates))
    np.testing.assert_allclose(inertia, case["I"], atol=case["tolerance"])
    np.testing.assert_allclose(coupling @ rates, case["C_thd"], atol=case["tolerance"])


def test_planar_3rrr_equals_the_numeric_model(golden, planar):
    case, (_, evaluate) = golden("dynamics_planar_3rrr"), planar
    robot = load_parallel("planar_3rrr")
    case = case | {"A": robot.base_points, "b_platform": robot.platform_points}
    numeric, rng, count = ParallelDynamics(robot.mechanism), np.random.default_rng(1), 0
    for _ in range(20):
        pose = [0.5, 0.3, 0.1] + rng.uniform(-0.08, 0.08, 3)
        T = np.eye(4)
        T[:2, :2] = [[np.cos(pose[2]), -np.sin(pose[2])], [np.sin(pose[2]), np.cos(pose[2])]]
        T[:2, 3] = pose[:2]
        rows = robot.mechanism.postures(T, ignore_limits=True).q
        for q in rows:
            rates = rng.normal(size=3)
            theta = q[robot.mechanism.drive_index]
            inertia, coupling = evaluate(planar_values(case, pose, theta, rates))
            expected = numeric.mass_matrix(q)
            if np.linalg.cond(expected) > 50.0:  # near a singularity digits are lost
                continue
            assert relative(inertia, expected) < 1e-12
            bias = numeric.inverse(q, rates, np.zeros(3))
            assert relative(coupling @ rates, bias) < 1e-12
            count += 1
    assert count > 30


CASTERS = [
    Wheel(kind="caster", position=(-0.4, 0.1), radius=0.06, trail=0.09, name="one"),
    Wheel(kind="caster", position=(0.3, -0.2), radius=0.05, trail=0.07, name="two"),
]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_two_wheels_equal_the_numeric_model(count):
    system, rng = symbolic_two_wheels(count), np.random.default_rng(2)
    evaluate = system.compiled()
    base = differential_drive(0.1, 0.4, casters=CASTERS[:count])
    driven = WheelBody(mass=0.6, spin=0.01, turn=0.004)
    bodies = [
        WheelBody(**dict(zip(
            ("mass", "spin", "turn", "bracket_mass", "bracket_inertia", "bracket_centre"),
            rng.uniform(0.1, 1.0, 6), strict=True)))
        for _ in range(count)
    ]  # fmt: skip
    platform = PlatformBody(mass=12.0, inertia=0.5, centre=[0.12, -0.05])
    numeric = RollingDynamics(base, platform, [driven, driven, *bodies])
    values = {"r": 0.1, "l": 0.4, "x_C": 0.12, "y_C": -0.05, "m_P": 12.0, "I_P": 0.5}
    values |= {"m_W": 0.6, "J_W": 0.01, "H_W": 0.004}
    for k, (wheel, body) in enumerate(zip(CASTERS, bodies, strict=False), start=1):
        values |= {f"x_{k}": wheel.position[0], f"y_{k}": wheel.position[1]}
        values |= {f"d_{k}": wheel.trail, f"r_{k}": wheel.radius, f"p_{k}": body.bracket_centre}
        values |= {f"m_{k}": body.mass, f"J_{k}": body.spin, f"H_{k}": body.turn}
        values |= {f"m_B{k}": body.bracket_mass, f"I_B{k}": body.bracket_inertia}
    for _ in range(20):
        rates, psi = rng.normal(size=2), rng.uniform(-3.0, 3.0, count)
        twist, _ = base.body_twist(rates)
        values |= {f"psi_{k + 1}": angle for k, angle in enumerate(psi)}
        values |= {"thetadot_1": rates[0], "thetadot_2": rates[1]}
        inertia, coupling = evaluate(values)
        expected, bias = numeric.drive_model(twist, psi)
        assert relative(inertia, expected) < 1e-12
        assert relative(coupling @ rates, bias) < 1e-12
        if count == 0:  # dI/dt = 0, so C itself is skew-symmetric
            assert np.abs(coupling + coupling.T).max() == 0.0


def test_omnidirectional_robot_equals_the_numeric_model():
    evaluate, rng = symbolic_omnidirectional().compiled(), np.random.default_rng(3)
    base = omnidirectional(3, 0.08, 0.3, offset=0.4)
    wheel = WheelBody(mass=0.5, spin=0.01, turn=0.006)
    numeric = RollingDynamics(base, PlatformBody(mass=9.0, inertia=0.4), [wheel] * 3)
    values = {"r": 0.08, "rho": 0.3, "m_P": 9.0, "I_P": 0.4}
    values |= {"m_W": 0.5, "J_W": 0.01, "H_W": 0.006}
    for _ in range(20):
        rates = rng.normal(size=3)
        twist, _ = base.body_twist(rates)
        inertia, coupling = evaluate(
            values | {f"thetadot_{i + 1}": rate for i, rate in enumerate(rates)}
        )
        expected, bias = numeric.drive_model(twist)
        assert relative(inertia, expected) < 1e-12
        assert relative(coupling @ rates, bias) < 1e-12


def test_golden_rolling_robots(golden):
    case = golden("dynamics_rolling")["omni3"]
    values = {"r": 0.05, "rho": 0.25, "m_P": case["m_total"], "I_P": case["I_total"]}
    values |= {"m_W": 0.0, "J_W": case["I_wheel_spin"], "H_W": 0.0}
    rates = -np.array(case["thd"])  # positive rates turn it clockwise here
    inertia, coupling = symbolic_omnidirectional().compiled()(
        values | {f"thetadot_{i + 1}": rate for i, rate in enumerate(rates)}
    )
    np.testing.assert_allclose(inertia, case["I"], atol=1e-10)
    np.testing.assert_allclose(-coupling @ rates, case["C_thd"], atol=1e-10)
    case = golden("dynamics_rolling")["differential"]
    values = {"r": case["r"], "l": case["track"], "x_C": case["com_forward"], "y_C": 0.0}
    values |= {"m_P": case["m_platform"], "I_P": case["Ic"], "m_W": case["m_wheel"]}
    values |= {"J_W": case["I_wheel_spin"], "H_W": case["I_wheel_vertical"]}
    right, left = case["thd_RL"]
    values |= {"thetadot_1": left, "thetadot_2": right}
    inertia, coupling = symbolic_two_wheels(0).compiled()(values)
    np.testing.assert_allclose(inertia, case["I"], atol=1e-10)
    np.testing.assert_allclose((coupling @ [left, right])[::-1], case["C_thd"], atol=1e-10)


def test_they_read_as_in_books(planar):
    wheels = symbolic_two_wheels(0)
    assert wheels.text("coupling").splitlines()[1::3] == [
        "C[1, 2] = -m_P*omega*r**2*x_C/l",
        "# omega = -r*thetadot_1/l + r*thetadot_2/l",
    ]
    text = planar[0].text("inertia").splitlines()
    assert text[1].startswith("I[1, 2] = I_2*(q_11*q_12 + q_21*q_22 + q_31*q_32) + I_P*n_11*n_12")
    named = [line.split()[1] for line in text if line.startswith("#")]
    assert named[:5] == ["k_1", "k_2", "k_3", "Delta", "h_11"] and named[-1] == "q_33"
    assert "T[3, 1] = 1" in planar[0].text("shape")
    latex = symbolic_omnidirectional().latex("inertia")
    assert latex.startswith("\\begin{align*}\nI_{11} &= ") and "\\rho^{2}" in latex
    # M T of the planar robot by hand: the platform's share.
    platform = planar[0].bodies[-1]
    assert platform.T[2, 0] == sympy.Symbol("n_11", real=True)


def test_what_is_wrong_is_named(planar):
    system = symbolic_omnidirectional()
    with pytest.raises(BadValueError, match=r"names of values is .*'J_W'.*expected exactly r, rho"):
        system.compiled()({"r": 0.1})
    names = [str(one) for one in (*system.symbols, *system.masses, *system.rates)]
    with pytest.raises(BadValueError, match="rho is nan"):
        system.compiled()(dict.fromkeys(names, 1.0) | {"rho": np.nan})
    with pytest.raises(BadValueError, match="'rho': 0.0.*lengths other than 0, a regular posture"):
        system.compiled()(dict.fromkeys(names, 1.0) | {"rho": 0.0})
    with pytest.raises(BadValueError, match="expression is 'torque'"):
        system.text("torque")
    with pytest.raises(BadValueError, match="casters is 10, expected a whole number from 0 to 9"):
        symbolic_two_wheels(10)
