"""Bodies under constraints of any kind: golden numbers, a chain as a case, reactions, refusals."""

import numpy as np
import pytest
from formulation_arms import GRAVITY, furnished, relative, states

from robomech_ros.dynamics import (
    ConstrainedBodies,
    constraint_reactions,
    inverse_dynamics,
    kinetic_energy,
    natural_orthogonal_complement,
)
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError


def planar(omega, v):
    """Twists [0, 0, omega, vx, vy, 0], one for each column."""
    omega, v = np.asarray(omega), np.asarray(v)
    return np.stack((0 * omega, 0 * omega, omega, v[0], v[1], 0 * omega))


def turned(v):
    """Vectors (2, ...) turned by a right angle."""
    return np.stack((-v[1], v[0]))


def planar_3rrr(case, theta, psi, phi):
    """T of seven bodies, and the rates of psi and platform for those of theta, by the loops."""
    b = np.array(case["b_platform"])
    c, s = np.cos(phi), np.sin(phi)
    arm = b @ np.array([[c, s], [-s, c]])
    own = np.eye(3)
    first = case["l1"] * np.stack((np.cos(theta), np.sin(theta)))
    second = case["l2"] * np.stack((np.cos(psi), np.sin(psi)))
    # What holds (x, y) + arm_i = A_i + first_i + second_i, along and across the second links.
    K = np.array([[second[0, i], second[1, i], turned(arm[i]) @ second[:, i]] for i in range(3)])
    J = np.diag([turned(first[:, i]) @ second[:, i] for i in range(3)])
    platform = np.linalg.solve(K, J)
    rows = []
    for i in range(3):
        tip = platform[:2] + np.outer(turned(arm[i]), platform[2])
        elbow = np.outer(turned(first[:, i]), own[i])
        psi_rate = turned(second[:, i]) @ (tip - elbow) / case["l2"] ** 2
        rows.append(planar(own[i], elbow / 2))
        rows.append(planar(psi_rate, elbow + np.outer(turned(second[:, i]), psi_rate) / 2))
    rows.append(planar(platform[2], platform[:2]))
    return np.concatenate(rows), [rows[1][2], rows[3][2], rows[5][2]], platform


def seven_bodies(case):
    """The robot of the golden file, in the state that it gives."""
    rates = np.array(case["thd"])
    at = (np.array(case["theta"]), np.array(case["psi_absolute"]), case["pose"][2])
    T, psi, platform = planar_3rrr(case, *at)
    step = 1e-5
    # Fourth order: the matrix is no better than its rate.
    T_dot = 0.0
    for weight, h in ((8, 1), (-8, -1), (-1, 2), (1, -2)):
        moved = (
            at[0] + h * step * rates,
            at[1] + h * step * (np.array(psi) @ rates),
            at[2] + h * step * (platform[2] @ rates),
        )
        T_dot = T_dot + weight * planar_3rrr(case, *moved)[0] / (12 * step)
    moments = [*(case["I1"], case["I2"]) * 3, case["Ip"]]
    inertias = np.zeros((7, 3, 3))
    inertias[:, 2, 2] = moments
    masses = [*(case["m1"], case["m2"]) * 3, case["mp"]]
    return ConstrainedBodies(masses=masses, inertias=inertias, T=T, T_dot=T_dot, rates=rates)


def test_golden_planar_3rrr(golden):
    case = golden("dynamics_planar_3rrr")
    robot = seven_bodies(case)
    np.testing.assert_allclose(
        robot.twists[[-4, -3, -2]][[1, 2, 0]], np.array(case["q_dot_platform"]), atol=1e-12
    )
    np.testing.assert_allclose(robot.generalised_inertia, case["I"], atol=1e-10)
    # Of a rate by differences.
    np.testing.assert_allclose(robot.coupling @ robot.rates, case["C_thd"], atol=1e-9)
    np.testing.assert_allclose(robot.forward(case["tau"]), case["thdd"], atol=1e-8)
    np.testing.assert_allclose(robot.inverse(case["thdd"]), case["tau"], atol=1e-9)


def differential(case):
    """Platform and two wheels that roll without slip: its constraints are not holonomic."""
    r, half, ahead = case["r"], case["track"] / 2, case["com_forward"]
    right, left = np.array(case["thd_RL"])
    J = np.array([[r / 2, r / 2], [r / (2 * half), -r / (2 * half)]])
    omega = J[1] @ [right, left]
    # At heading 0: platform, then wheels at (0, -half) and (0, half) that spin about y.
    T, T_dot = np.zeros((18, 2)), np.zeros((18, 2))
    T[2], T[3], T[4] = J[1], J[0], ahead * J[1]
    T_dot[3], T_dot[4] = -omega * T[4], omega * T[3]
    for row, side, spin in ((6, -half, [1, 0]), (12, half, [0, 1])):
        T[row + 1], T[row + 2], T[row + 3] = spin, J[1], J[0] - side * J[1]
        T_dot[row], T_dot[row + 4] = -omega * T[row + 1], omega * T[row + 3]
    wheel = np.diag([case["I_wheel_vertical"], case["I_wheel_spin"], case["I_wheel_vertical"]])
    return ConstrainedBodies(
        masses=[case["m_platform"], case["m_wheel"], case["m_wheel"]],
        inertias=[np.diag([0.1, 0.1, case["Ic"]]), wheel, wheel],
        T=T,
        T_dot=T_dot,
        rates=[right, left],
    )


def test_golden_differential_drive(golden):
    case = golden("dynamics_rolling")["differential"]
    robot = differential(case)
    np.testing.assert_allclose(robot.generalised_inertia, case["I"], atol=1e-12)
    np.testing.assert_allclose(robot.coupling @ robot.rates, case["C_thd"], atol=1e-12)
    np.testing.assert_allclose(robot.forward(case["tau_RL"]), case["thdd"], atol=1e-10)


@pytest.fixture(params=["RRRRRR", "RPRPRR", "PRP"])
def arm(request, random_chain):
    types = ["RP".index(kind) for kind in request.param]
    return furnished(random_chain(5, len(types), types), 2, drives=True)


def test_a_chain_is_a_case(arm):
    for q, qd, qdd in zip(*states(arm, 10), strict=True):
        model = natural_orthogonal_complement(arm, q, qd)
        names = ("masses", "inertias", "T", "T_dot", "rates", "rotors")
        bodies = ConstrainedBodies(**{name: getattr(model, name) for name in names})
        tau = bodies.inverse(qdd, bodies.gravity_wrenches(GRAVITY))
        assert relative(tau, inverse_dynamics(arm, q, qd, qdd, gravity=GRAVITY)) < 1e-10
        assert relative(bodies.forward(tau, bodies.gravity_wrenches(GRAVITY)), qdd) < 1e-10
        assert abs(bodies.kinetic_energy / kinetic_energy(arm, q, qd) - 1.0) < 1e-12


def test_other_rates_give_the_same_power(arm):
    """Rotors at joints whose rates are not the independent ones, by a constant change of rates."""
    mix = np.random.default_rng(3).normal(size=(arm.n, arm.n))
    for q, qd, qdd in zip(*states(arm, 5), strict=True):
        model = natural_orthogonal_complement(arm, q, qd)
        other = ConstrainedBodies(
            masses=model.masses,
            inertias=model.inertias,
            T=model.T @ mix,
            T_dot=model.T_dot @ mix,
            rates=np.linalg.solve(mix, qd),
            rotors=model.rotors,
            N=mix,
            N_dot=np.zeros_like(mix),
        )
        expected = mix.T @ inverse_dynamics(arm, q, qd, qdd, gravity=GRAVITY)
        found = other.inverse(np.linalg.solve(mix, qdd), other.gravity_wrenches(GRAVITY))
        assert relative(found, expected) < 1e-9
        assert abs(other.kinetic_energy / model.kinetic_energy - 1.0) < 1e-9


def test_reactions_of_a_chain_are_the_only_ones(arm):
    q, qd, qdd = (rows[0] for rows in states(arm, 1))
    model = natural_orthogonal_complement(arm, q, qd)
    wrenches = model.constraint_wrenches(qdd, model.gravity_wrenches(GRAVITY))
    size = np.abs(wrenches).max()
    assert abs(model.power(wrenches)) < 1e-10 * size
    # The book's constraints are six for a joint, of which five are independent.
    found = constraint_reactions(model.K, wrenches)
    assert found.redundant == arm.n and not found.unique
    assert found.remainder < 1e-10 * size
    rows = np.linalg.svd(model.K)[2][: 5 * arm.n]
    found = constraint_reactions(rows, wrenches)
    assert found.unique and found.redundant == 0
    np.testing.assert_allclose(rows.T @ found.multipliers, wrenches, atol=1e-10 * size)


GOOD = {
    "masses": [2.0],
    "inertias": np.zeros((1, 3, 3)),
    "T": np.eye(6)[:, 3:4],
    "T_dot": np.zeros((6, 1)),
    "rates": [0.5],
}


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("masses", [], WrongSizeError),
        ("masses", [-1.0], BadValueError),
        ("masses", None, BadValueError),
        ("inertias", np.zeros((2, 3, 3)), WrongSizeError),
        ("T", np.zeros((12, 1)), WrongSizeError),
        ("T_dot", np.full((6, 1), np.nan), NonFiniteError),
        ("rates", 0.5, WrongSizeError),
        ("rates", "fast", BadValueError),
        ("rotors", [-1.0], BadValueError),
        ("rotors", 1.0, WrongSizeError),
        ("N", np.zeros((2, 2)), WrongSizeError),
        ("t_0", np.zeros(5), WrongSizeError),
    ],
)
def test_wrong_arrays_are_named(name, value, error):
    with pytest.raises(error, match=name):
        ConstrainedBodies(**(GOOD | {name: value}))


def test_wrong_arguments_of_methods_are_named():
    sled = ConstrainedBodies(**GOOD)
    with pytest.raises(WrongSizeError, match="accelerations"):
        sled.inverse([1.0, 2.0])
    with pytest.raises(WrongSizeError, match="wrenches"):
        sled.forward([1.0], [0.0] * 12)
    with pytest.raises(BadValueError, match="A"):
        sled.constraint_wrenches([1.0], np.zeros(6))
    weightless = ConstrainedBodies(**(GOOD | {"masses": [0.0]}))
    with pytest.raises(BadValueError, match="resist"):
        weightless.forward([1.0])
    with pytest.raises(WrongSizeError, match="K"):
        constraint_reactions([], [])
    with pytest.raises(WrongSizeError, match="wrenches"):
        constraint_reactions(np.zeros((1, 6)), [0.0] * 5)
