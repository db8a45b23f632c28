"""Parallel robots: efforts and accelerations against multipliers, golden numbers, refusals."""

import numpy as np
import pytest
from tree_of_pinocchio import TreeOfPinocchio

from robomech_ros.dynamics import torque_summary
from robomech_ros.errors import (
    BadValueError,
    MissingInertiaError,
    NonFiniteError,
    UnknownLinkError,
    WrongSizeError,
)
from robomech_ros.outcomes import Code
from robomech_ros.parallel import LinkBodies, ParallelDynamics, list_parallel, load_parallel
from robomech_ros.robots import Body, Drive

GRAVITY, WRENCH = (1.0, -2.0, -9.0), (1.0, -2.0, 3.0, 40.0, -50.0, 60.0)


def relative(one, other):
    """Largest difference over the largest magnitude."""
    one, other = np.asarray(one), np.asarray(other)
    return np.abs(one - other).max() / max(np.abs(other).max(), 1e-300)


@pytest.fixture(scope="module", params=list_parallel())
def robot(request):
    """The dynamics of a robot of the library."""
    return ParallelDynamics(load_parallel(request.param).mechanism)


@pytest.fixture(scope="module")
def hexapod():
    return ParallelDynamics(load_parallel("hexapod").mechanism)


def states(robot, count, seed=3):
    """Postures near home with closed loops, rates and accelerations of the drives."""
    rng, mechanism = np.random.default_rng(seed), robot.mechanism
    home, m = mechanism.home(), mechanism.dof
    weights = mechanism.loops.weights[mechanism.drive_index]
    found = []
    while len(found) < count:
        way = 0.05 * rng.uniform(-1.0, 1.0, m) / weights
        closed = mechanism.close(home[mechanism.drive_index] + way, home)
        if closed.status == Code.NONE:
            found.append(closed.q)
    return np.array(found), *(rng.normal(size=(2, count, m)) / weights)


def test_golden_planar_3rrr(golden):
    case = golden("dynamics_planar_3rrr")
    mechanism = load_parallel("planar_3rrr").mechanism
    robot = ParallelDynamics(mechanism)
    x, y, phi = case["pose"]
    T = np.eye(4)
    T[:2, :2] = [[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]]
    T[:2, 3] = x, y
    rows = mechanism.postures(T, ignore_limits=True).q
    away = rows[:, mechanism.drive_index] - case["theta"]
    q = rows[np.abs(np.remainder(away + np.pi, 2.0 * np.pi) - np.pi).max(axis=1).argmin()]
    rates, tolerance = np.array(case["thd"]), case["tolerance"]
    np.testing.assert_allclose(robot.mass_matrix(q), case["I"], atol=tolerance)
    bias = robot.inverse(q, rates, np.zeros(3))
    np.testing.assert_allclose(bias, case["C_thd"], atol=tolerance)
    C = robot.coriolis_matrix(q, rates)
    np.testing.assert_allclose(C @ rates, case["C_thd"], atol=tolerance)
    np.testing.assert_allclose(robot.forward(q, rates, case["tau"]), case["thdd"], atol=1e-9)


def test_agrees_with_multipliers_on_the_tree_of_pinocchio(robot):
    tree = TreeOfPinocchio(robot.mechanism, GRAVITY)
    for q, rates, gains in zip(*states(robot, 10), strict=True):
        qd = robot.joint_rates(q, rates)
        qdd = robot.mechanism.accelerations(q, qd, gains)[0]
        efforts = robot.inverse(q, rates, gains, gravity=GRAVITY)
        assert relative(efforts, tree.inverse(q, qd, qdd)) < 1e-10
        found, _ = tree.forward(q, qd, efforts)
        assert relative(found[robot.drives_at], gains) < 1e-9
        assert relative(robot.forward(q, rates, efforts, gravity=GRAVITY), gains) < 1e-10


def test_the_matrices_of_all_links_give_the_same(robot):
    for q, rates, gains in zip(*states(robot, 5), strict=True):
        bodies = robot.bodies(q, rates)
        weights = bodies.gravity_wrenches(GRAVITY)
        efforts = robot.inverse(q, rates, gains, gravity=GRAVITY)
        assert relative(bodies.inverse(gains, weights), efforts) < 1e-10
        assert relative(bodies.forward(efforts, weights), gains) < 1e-10
        assert relative(bodies.generalised_inertia, robot.mass_matrix(q)) < 1e-12
        assert relative(bodies.kinetic_energy, robot.kinetic_energy(q, rates)) < 1e-12
        np.testing.assert_allclose(bodies.T.T @ bodies.A, np.eye(robot.mechanism.dof), atol=1e-12)


def test_the_inertia_is_positive_and_its_rate_less_twice_the_coupling_skew(robot):
    (q, *_), (rates, *_), _ = states(robot, 1)
    inertia = robot.mass_matrix(q)
    assert (inertia == inertia.T).all()
    assert np.linalg.eigvalsh(inertia).min() > 0.0
    h, drives, rate = 1e-4, q[robot.drives_at], 0.0
    for weight, step in ((8, 1), (-8, -1), (-1, 2), (1, -2)):
        at = robot.posture(drives + step * h * rates, q)
        rate = rate + weight * robot.mass_matrix(at) / (12.0 * h)
    difference = rate - 2.0 * robot.coriolis_matrix(q, rates)
    scale = np.abs(rate).max() + np.abs(inertia).max()
    np.testing.assert_allclose(difference, -difference.T, atol=1e-7 * scale)


def test_power_of_the_drives_becomes_energy(robot):
    """Rates of both energies by differences, and of the wrench on the platform."""
    (q, *_), (rates, *_), (gains, *_) = states(robot, 1)
    efforts = robot.inverse(q, rates, gains, gravity=GRAVITY, tip_wrench=WRENCH)
    h, drives = 1e-5, q[robot.drives_at]
    energies = []
    for t in (h, -h):
        at = robot.posture(drives + t * rates + 0.5 * t * t * gains, q)
        energy = robot.kinetic_energy(at, rates + t * gains)
        energies.append(energy + robot.potential_energy(at, gravity=GRAVITY))
    rate = (energies[0] - energies[1]) / (2.0 * h)
    power = efforts @ rates + np.array(WRENCH) @ robot.tip_twist(q, rates)
    assert abs(power - rate) < 1e-6 * (abs(rate) + np.abs(efforts * rates).max())


def test_a_batch_is_its_states(hexapod):
    q, rates, gains = states(hexapod, 6)
    shaped = [one.reshape(2, 3, -1) for one in (q, rates, gains)]
    around = {"gravity": GRAVITY, "tip_wrench": WRENCH}
    for function in (hexapod.inverse, hexapod.forward):
        rows = [function(*row, **around) for row in zip(q, rates, gains, strict=True)]
        np.testing.assert_array_equal(function(*shaped, **around).reshape(6, 6), rows)
    rows = [hexapod.mass_matrix(row) for row in q]
    np.testing.assert_array_equal(hexapod.mass_matrix(shaped[0]).reshape(6, 6, 6), rows)
    rows = [hexapod.bodies(*row).coupling for row in zip(q, rates, strict=True)]
    found = hexapod.coriolis_matrix(*shaped[:2]).reshape(6, 6, 6)
    np.testing.assert_allclose(found, rows, atol=1e-12)


def test_what_rests_on_the_base_is_the_weight_and_the_load(robot):
    q = robot.mechanism.home()
    still = np.zeros(robot.mechanism.dof)
    found = robot.reactions(q, still, still, gravity=GRAVITY, tip_wrench=WRENCH)
    first = robot.mechanism.loops.starts[:-1]
    force = found.wrenches[first, 3:].sum(axis=0)
    expected = -robot.mass * np.array(GRAVITY) - np.array(WRENCH[3:])
    np.testing.assert_allclose(force, expected, atol=1e-9 * np.abs(expected).max())
    # A planar robot could do with spherical joints instead of parallel axes, a spherical one too.
    redundant = {"planar_3rpr": 6, "planar_3rrr": 6, "agile_eye": 6}.get(robot.name, 0)
    assert found.redundant == redundant
    assert found.unique == (redundant == 0)
    # A drive exerts its effort along its own axis.
    efforts = robot.inverse(q, still, still, gravity=GRAVITY, tip_wrench=WRENCH)
    for effort, joint in zip(efforts, robot.drives_at, strict=True):
        along = robot.mechanism.types[joint] == 1
        size = np.linalg.norm(found.wrenches[joint, 3:] if along else found.wrenches[joint, :3])
        assert size >= abs(effort) * (1.0 - 1e-9)


def test_reactions_in_motion_are_what_newton_and_euler_ask_for(hexapod):
    """A weightless leg bears along its length only: of one with mass the spherical joint."""
    q, rates, gains = (one[0] for one in states(hexapod, 1))
    light = LinkBodies({"platform": hexapod.mechanism.platform_body})
    source = load_parallel("hexapod")
    source.parts = light
    robot = ParallelDynamics(source.mechanism)
    found = robot.reactions(q, rates, gains, gravity=GRAVITY)
    for leg, start in enumerate(robot.mechanism.loops.starts[:-1]):
        base, tip = found.wrenches[start], found.wrenches[start + 3]
        np.testing.assert_allclose(base[:3], 0.0, atol=1e-9 * np.abs(base[3:]).max())
        np.testing.assert_allclose(base[3:], tip[3:], atol=1e-9 * np.abs(base[3:]).max())
        effort = robot.inverse(q, rates, gains, gravity=GRAVITY)[leg]
        assert abs(np.linalg.norm(base[3:]) - abs(effort)) < 1e-9 * abs(effort)


def test_friction_of_drives_and_of_passive_joints(hexapod):
    q, rates, _ = (one[0] for one in states(hexapod, 1))
    expected = 120.0 * rates + 8.0 * np.sign(rates)
    np.testing.assert_allclose(hexapod.friction(q, rates), expected, atol=1e-12)
    assert (ParallelDynamics(load_parallel("planar_3rrr").mechanism).friction_rows == 0.0).all()


def test_a_payload_adds_its_weight_and_its_inertia(robot):
    q, rates, gains = (one[0] for one in states(robot, 1))
    load = Body(3.0, [0.1, -0.2, 0.3], np.diag([0.02, 0.03, 0.04]))
    loaded = robot.with_payload(load)
    assert abs(loaded.mass - robot.mass - 3.0) < 1e-12
    tree = TreeOfPinocchio(loaded.mechanism, GRAVITY)
    qd = robot.joint_rates(q, rates)
    qdd = robot.mechanism.accelerations(q, qd, gains)[0]
    efforts = loaded.inverse(q, rates, gains, gravity=GRAVITY)
    assert relative(efforts, tree.inverse(q, qd, qdd)) < 1e-10
    assert relative(efforts, robot.inverse(q, rates, gains, gravity=GRAVITY)) > 1e-4


def test_a_summary_of_efforts(hexapod):
    q, rates, gains = states(hexapod, 4)
    found = torque_summary(hexapod, [0.0, 0.1, 0.2, 0.3], q, rates, gains)
    efforts = hexapod.inverse(q, rates, gains)
    np.testing.assert_allclose(found.peak_effort, np.abs(efforts).max(axis=0))
    limit = hexapod.mechanism.effort[hexapod.drives_at]
    np.testing.assert_array_equal(found.effort_limit, limit)


def test_wrong_requests_are_named(hexapod):
    q, still = hexapod.mechanism.home(), np.zeros(6)
    for wrong, error, words in (
        (q[:5], WrongSizeError, "q"),
        (np.full(36, np.nan), NonFiniteError, "q"),
        ("home", BadValueError, "q"),
    ):
        with pytest.raises(error, match=words):
            hexapod.inverse(wrong, still, still)
    open_loops = q.copy()
    open_loops[9] += 0.01
    with pytest.raises(BadValueError, match=r"q has open loops: limb 2 ends 0\.00"):
        hexapod.inverse(open_loops, still, still)
    with pytest.raises(BadValueError, match="closed loops"):
        hexapod.checked_posture(open_loops)
    with pytest.raises(WrongSizeError, match="rates"):
        hexapod.inverse(q, q, still)
    with pytest.raises(WrongSizeError, match="efforts"):
        hexapod.forward(q, still, [1.0])
    with pytest.raises(BadValueError, match="payload"):
        hexapod.with_payload(3.0)
    with pytest.raises(BadValueError, match="payload"):
        hexapod.with_payload(Body(-1.0, np.zeros(3), np.eye(3)))
    with pytest.raises(BadValueError, match="mechanism"):
        ParallelDynamics(load_parallel("hexapod"))


def test_parts_that_do_not_fit_are_named():
    robot = load_parallel("hexapod")
    body = Body(1.0, np.zeros(3), np.eye(3))
    robot.parts = LinkBodies({"platform": body, "piston": body})
    with pytest.raises(UnknownLinkError, match=r"'piston'.*cylinder"):
        _ = robot.mechanism
    robot.parts = LinkBodies({"leg2_rod": body})
    with pytest.raises(MissingInertiaError, match="platform"):
        ParallelDynamics(robot.mechanism).mass_matrix(robot.mechanism.home())
    for wrong in ({"bodies": {"rod": 3.0}}, {"bodies": [body]}, {"drive": 3.0}):
        with pytest.raises(BadValueError, match="bod|drive"):
            LinkBodies(**wrong)
    with pytest.raises(BadValueError, match=r"'rod'.*positive"):
        LinkBodies({"rod": Body(-1.0, np.zeros(3), np.eye(3))})
    robot = load_parallel("hexapod")
    robot.parts = LinkBodies({"platform": body, "leg2_rod": body}, Drive(viscous=2.0))
    bodies = [limb.chain.bodies[2] for limb in robot.mechanism.limbs]
    assert [one is not None for one in bodies] == [False, True, False, False, False, False]
    assert robot.mechanism.limbs[3].chain.drives[2].viscous == 2.0
