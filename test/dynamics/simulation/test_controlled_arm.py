"""A chain under a controller of torques: it tracks, sticks, saturates, and tells."""

import dataclasses

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import pinocchio_of

from robomech_ros.dynamics import (
    ControlledArm,
    friction_torque,
    gravity_torque,
    kinetic_energy,
    mass_matrix,
    potential_energy,
    with_payload,
)
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots import Body, Drive, load_robot

PUMA = load_robot("puma560")
LOAD = Body(2.0, [0, 0, 0.1], 0.005 * np.eye(3))


def sines(chain, seconds, size=0.5):
    t = np.arange(round(1000 * seconds))[:, None] * 1e-3
    w = np.linspace(0.7, 1.7, chain.n)
    return np.stack(
        (
            chain.midrange() + size * np.sin(w * t),
            size * w * np.cos(w * t),
            -size * w**2 * np.sin(w * t),
        ),
        axis=1,
    )


def run(servo, wanted):
    q, qd = wanted[0, 0].copy(), wanted[0, 1].copy()
    motion = servo.run(q, qd, wanted)
    return motion, motion.q[:-1] - wanted[1:, 0]


@pytest.mark.parametrize("control", ["computed-torque", "pd-gravity"])
def test_a_known_arm_is_tracked(control):
    motion, error = run(ControlledArm(PUMA, control=control), sines(PUMA, 3.0))
    assert motion.reason == "" and not motion.saturated.any()
    assert np.abs(error).max() < {"computed-torque": 1e-4, "pd-gravity": 2e-3}[control]
    assert motion.q.shape == motion.qd.shape == motion.effort.shape == (3000, 6)


def test_a_payload_that_the_model_does_not_know_costs_some_milliradians():
    motion, error = run(ControlledArm(PUMA, with_payload(PUMA, LOAD)), sines(PUMA, 3.0))
    assert motion.reason == ""
    assert 1e-4 < np.abs(error).max() < 1e-2
    known, error = run(ControlledArm(with_payload(PUMA, LOAD)), sines(PUMA, 3.0))
    assert known.reason == "" and np.abs(error).max() < 1e-4


def reach(chain, seconds=1.0):
    """Rest to rest by a quintic, from the middle of the ranges, and half a second at the goal."""
    count = round(1000 * seconds)
    s = np.minimum(np.arange(count + 500) / count, 1.0)[:, None]
    way = np.resize([0.5, -0.4, 0.5, -0.3], chain.n)
    laws = (
        s**3 * (10 - 15 * s + 6 * s * s),
        30 * (s * (1 - s)) ** 2 / seconds,
        60 * s * (1 - s) * (1 - 2 * s) / seconds**2,
    )
    wanted = np.stack([law * way for law in laws], axis=1)
    wanted[:, 0] += chain.midrange()
    return wanted


@pytest.mark.parametrize("robot", ["ur5e", "ur10e", "xarm6", "crx10ia", "m1013", "vx300", "panda"])
def test_fixed_gains_bring_arms_to_rest_wherever_they_are(robot):
    chain = load_robot(robot)
    servo = ControlledArm(chain, control="pd-gravity")
    rng = np.random.default_rng(5)
    for _ in range(20):
        start = rng.uniform(np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi))
        wanted = np.zeros((1000, 3, chain.n))
        wanted[:, 0] = np.clip(start + rng.uniform(-0.05, 0.05, chain.n), chain.lower, chain.upper)
        motion = servo.run(start, np.zeros(chain.n), wanted)
        assert motion.reason == "" and not motion.saturated[-500:].any()
        assert np.abs(motion.q[-1] - wanted[-1, 0]).max() < 1e-3


@pytest.mark.parametrize("robot", ["ur10e", "vx300", "xarm6"])
def test_pinocchio_moves_the_same_way_under_the_same_law(robot):
    """Its articulated bodies, in steps whose rates at the end give the values."""
    chain = load_robot(robot)
    model = pinocchio_of(chain)
    data, n = model.createData(), chain.n
    goal = chain.midrange() + 0.1
    felt = 1.0 / np.diag(np.linalg.inv(mass_matrix(chain, goal)))
    kp, kd = 400.0 * felt, 20.0 * felt
    q, qd = goal - np.linspace(0.05, 0.02, n), np.zeros(n)
    wanted = np.zeros((300, 3, n))
    wanted[:, 0] = goal
    motion = ControlledArm(chain, control="pd-gravity", kp=kp, kd=kd).run(
        q.copy(), qd.copy(), wanted
    )
    for _ in wanted:
        holding = pinocchio.computeGeneralizedGravity(model, data, q)
        tau = np.clip(kp * (goal - q) - kd * qd + holding, -chain.effort, chain.effort)
        qd = qd + 1e-3 * pinocchio.aba(model, data, q, qd, tau)
        q = q + 1e-3 * qd
    assert np.abs(qd).max() > 1e-3
    np.testing.assert_allclose(motion.q[-1], q, atol=1e-12)
    np.testing.assert_allclose(motion.qd[-1], qd, atol=1e-11)


# Where they fold up and have the least inertia about one of their motions.
FOLDED = {
    "vx300": [-1.9, -0.119, -1.545, 0.24, 3.13],
    "xarm6": [3.14, -0.13, -2.785, -0.9, 0.824, -0.04],
    "ur5e": [-0.713, 1.57, 0.0, -1.571, -0.002, -3.14],
}


@pytest.mark.parametrize("robot", FOLDED)
@pytest.mark.parametrize(
    ("bandwidth", "damping"), [(50.0, 1.0), (1000.0, 1.0), (1000.0, 0.1), (1e6, 1.0), (50.0, 100.0)]
)
def test_fixed_gains_are_quiet_where_an_arm_folds_up(robot, bandwidth, damping):
    chain = load_robot(robot)
    servo = ControlledArm(chain, control="pd-gravity", bandwidth=bandwidth, damping=damping)
    start = np.array(FOLDED[robot])
    wanted = np.zeros((1000, 3, chain.n))
    wanted[:, 0] = start + 1e-4 * np.random.default_rng(0).uniform(-1.0, 1.0, chain.n)
    motion = servo.run(start, np.zeros(chain.n), wanted)
    assert motion.reason == "" and not motion.saturated[-100:].any()
    assert np.abs(np.diff(motion.qd[-100:], axis=0)).max() < 1e-4


@pytest.mark.parametrize(
    "given",
    [
        {"bandwidth": 1e-300, "damping": 1e-300},
        {"bandwidth": 1e-200, "period": 1e-200},
        {"bandwidth": 1e6, "damping": 1e6, "period": 1e308},
    ],
)
def test_fixed_gains_are_numbers_however_small_or_large_their_grounds(given):
    start = PUMA.midrange()
    wanted = np.zeros((10, 3, PUMA.n))
    wanted[:, 0] = start
    motion = ControlledArm(PUMA, control="pd-gravity", **given).run(
        start, np.zeros(PUMA.n), wanted, period=1e-3
    )
    assert motion.reason == "" and np.abs(motion.q - wanted[0, 0]).max() < 1e-3


@pytest.mark.parametrize("robot", ["puma560", "ur5e", "panda"])
@pytest.mark.parametrize(("control", "tracked"), [("computed-torque", 5e-3), ("pd-gravity", 0.075)])
def test_an_observer_makes_up_for_a_payload(robot, control, tracked):
    chain = load_robot(robot)
    load = Body(2.0, [0.0, 0.0, 0.05], np.zeros((3, 3)))
    plain = ControlledArm(chain, with_payload(chain, load), control=control)
    watching = dataclasses.replace(plain, observer=2000.0)
    _, without = run(plain, reach(chain))
    motion, error = run(watching, reach(chain))
    assert motion.reason == "" and not motion.saturated.any()
    assert np.abs(error).max() < min(tracked, 0.8 * np.abs(without).max())
    assert np.abs(error[-50:]).max() < 4e-3


def test_an_observer_finds_nothing_where_the_model_is_right():
    wanted = sines(PUMA, 0.5)
    plain, watching = ControlledArm(PUMA), ControlledArm(PUMA, observer=2000.0)
    states = []
    for servo in (plain, watching):
        q, qd, observed = wanted[0, 0].copy(), wanted[0, 1].copy(), np.zeros(6)
        servo.run(q, qd, wanted, observed=observed)
        states.append(q)
    np.testing.assert_allclose(*states, atol=1e-12)
    assert np.abs(observed).max() < 1e-9


def test_what_was_observed_is_kept_but_not_at_a_stop():
    chain = load_robot("ur5e")
    servo = ControlledArm(chain, with_payload(chain, LOAD), observer=2000.0)
    q, qd, observed = np.array([0.0, -1.2, 1.2, -1.0, -1.5, 0.0]), np.zeros(6), np.zeros(6)
    wanted = np.zeros((300, 3, 6))
    wanted[:, 0] = q
    servo.run(q, qd, wanted, observed=observed)
    weight = gravity_torque(servo.plant, q) - gravity_torque(chain, q)
    np.testing.assert_allclose(observed, weight, atol=1e-3 * np.abs(weight).max())
    held = np.arange(6) == 1
    servo.run(q, qd, wanted[:50], held=held, observed=observed)
    assert (observed == 0.0).tolist() == held.tolist()
    # Released, it falls hardly before the weight is known again.
    motion = servo.run(q, qd, wanted, observed=observed)
    assert np.abs(motion.q - wanted[:, 0]).max() < 2e-3


def test_an_observer_does_not_push_a_joint_against_its_stop():
    chain = dataclasses.replace(load_robot("ur5e"), upper=np.full(6, 1.0), lower=np.full(6, -3.0))
    servo = ControlledArm(chain, with_payload(chain, LOAD), observer=2000.0)
    q, qd, observed = np.full(6, 0.5), np.zeros(6), np.zeros(6)
    wanted = np.zeros((2000, 3, 6))
    wanted[:, 0] = np.interp(np.arange(2000), [0, 700, 1400], [0.5, 1.1, 0.5])[:, None]
    motion = servo.run(q, qd, wanted, observed=observed)
    assert motion.reason == "" and motion.q.max() <= 1.0 + 1e-12
    np.testing.assert_allclose(q, 0.5, atol=1e-3)


def test_a_motion_goes_on_where_it_was():
    servo, wanted = ControlledArm(PUMA, with_payload(PUMA, LOAD)), sines(PUMA, 0.2)
    q, qd = wanted[0, 0].copy(), wanted[0, 1].copy()
    whole = servo.run(q.copy(), qd.copy(), wanted)
    parts = [servo.run(q, qd, part) for part in np.split(wanted, 4)]
    np.testing.assert_array_equal(whole.q, np.concatenate([part.q for part in parts]))
    np.testing.assert_array_equal(whole.q[-1], q)
    np.testing.assert_array_equal(whole.qd[-1], qd)


def test_shorter_steps_come_to_the_same_motion():
    slow = ControlledArm(PUMA, with_payload(PUMA, LOAD))
    fine = dataclasses.replace(slow, substeps=20)
    wanted = sines(PUMA, 1.0)
    assert np.abs(run(slow, wanted)[0].q - run(fine, wanted)[0].q).max() < 1e-3


def test_saturation_is_told_and_stays_within_the_limits():
    weak = dataclasses.replace(PUMA, effort=np.array([97.6, 10.0, 89.4, 24.2, 20.1, 21.3]))
    motion, error = run(ControlledArm(weak), sines(weak, 1.0))
    assert motion.saturated[:, 1].any() and not motion.saturated[:, 0].any()
    assert np.abs(motion.effort).max(axis=0)[1] == 10.0
    assert motion.reason == "" and np.isfinite(error).all()


def test_friction_holds_what_weighs_less_than_it():
    heavy = dataclasses.replace(PUMA, drives=tuple(Drive(1.0, 100.0) for _ in range(6)))
    q = np.linspace(0.1, 0.6, 6)
    assert (np.abs(gravity_torque(heavy, q)) < 100.0).all()
    # No torque at all: the gains are zero, and gravity is not known.
    idle = ControlledArm(
        dataclasses.replace(heavy, effort=np.full(6, 1e-9)), heavy, kp=np.zeros(6), kd=np.zeros(6)
    )
    wanted = np.zeros((500, 3, 6))
    start = q.copy()
    motion = idle.run(q, np.zeros(6), wanted)
    np.testing.assert_array_equal(motion.q, np.tile(start, (500, 1)))
    np.testing.assert_array_equal(motion.qd, 0.0)


def test_friction_stops_a_joint_and_breaks_away_at_the_static_friction():
    drives = (Drive(0.0, 1.0, 3.0, 0.1), Drive(), Drive())
    arm = dataclasses.replace(load_robot("planar3r"), drives=drives)
    ideal = dataclasses.replace(arm, drives=())
    for torque, moves in ((2.9, False), (3.1, True)):
        limited = dataclasses.replace(ideal, effort=np.array([torque, 1e-9, 1e-9]))
        pushed = ControlledArm(limited, arm, kp=np.zeros(3), kd=np.zeros(3), gravity=np.zeros(3))
        wanted = np.zeros((200, 3, 3))
        wanted[:, 2, 0] = 1e6
        q = np.zeros(3)
        motion = pushed.run(q, np.zeros(3), wanted)
        assert (abs(motion.q[-1, 0]) > 1e-3) == moves, torque
    coasting = ControlledArm(
        dataclasses.replace(ideal, effort=np.full(3, 1e-12)), arm, gravity=np.zeros(3)
    )
    motion = coasting.run(np.zeros(3), np.array([0.2, 0, 0]), np.zeros((3000, 3, 3)))
    assert motion.qd[-1, 0] == 0.0


def test_stops_hold_without_a_rebound():
    arm = load_robot("planar3r")
    fallen = ControlledArm(
        dataclasses.replace(arm, effort=np.full(3, 1e-9)),
        arm,
        kp=np.zeros(3),
        kd=np.zeros(3),
        gravity=[0, -9.81, 0],
    )
    q, qd = np.zeros(3), np.zeros(3)
    motion = fallen.run(q, qd, np.zeros((5000, 3, 3)))
    assert (motion.q >= arm.lower - 1e-12).all() and (motion.q <= arm.upper + 1e-12).all()
    assert (np.abs(motion.q - arm.lower) < 1e-9).any() or (
        np.abs(motion.q - arm.upper) < 1e-9
    ).any()
    energy = kinetic_energy(arm, motion.q, motion.qd) + potential_energy(
        arm, motion.q, gravity=[0, -9.81, 0]
    )
    # Steps of first order swing by some percent, and stops only take.
    assert energy.max() < energy[0] + 0.05 * np.ptp(energy) + 0.5


def test_a_controller_that_runs_away_is_stopped_and_told():
    limitless = dataclasses.replace(
        PUMA, effort=np.full(6, np.nan), lower=np.full(6, -np.inf), upper=np.full(6, np.inf)
    )
    wild = ControlledArm(limitless, kp=np.full(6, 1e9), kd=np.full(6, 0.0))
    wanted = sines(PUMA, 1.0)
    q, qd = wanted[0, 0] + 0.5, wanted[0, 1].copy()
    motion = wild.run(q, qd, wanted)
    assert np.isfinite(motion.q).all() and np.isfinite(q).all() and np.isfinite(qd).all()
    assert "ran away after" in motion.reason and len(motion.q) < len(wanted)


def test_the_friction_of_the_model_is_added():
    stiff, wanted = ControlledArm(PUMA), np.zeros((1, 3, 6))
    wanted[:, 1] = 0.1
    motion = stiff.run(np.zeros(6), np.full(6, 0.1), wanted)
    ideal = ControlledArm(
        dataclasses.replace(
            PUMA,
            drives=tuple(
                Drive(rotor_inertia=drive.rotor_inertia, gear_ratio=drive.gear_ratio)
                for drive in PUMA.drives
            ),
        ),
        PUMA,
    )
    without = ideal.run(np.zeros(6), np.full(6, 0.1), wanted)
    added = motion.effort[0] - without.effort[0]
    np.testing.assert_allclose(added, friction_torque(PUMA, np.full(6, 0.1)), rtol=1e-12)


def test_what_is_refused():
    with pytest.raises(WrongSizeError, match="joints of the plant has size 3, expected 6"):
        ControlledArm(PUMA, load_robot("planar3r"))
    for name, value in (
        ("control", "pid"),
        ("bandwidth", 0.0),
        ("period", -1e-3),
        ("period", np.nan),
        ("substeps", 0),
        ("substeps", 1.5),
        ("kp", np.full(6, -1.0)),
        ("observer", -1.0),
        ("observer", np.nan),
    ):
        with pytest.raises(BadValueError, match=name):
            ControlledArm(PUMA, **{name: value})
    servo, wanted = ControlledArm(PUMA), np.zeros((2, 3, 6))
    with pytest.raises(WrongSizeError, match="wanted"):
        servo.run(np.zeros(6), np.zeros(6), np.zeros((3, 6)))
    with pytest.raises(NonFiniteError, match="wanted"):
        servo.run(np.zeros(6), np.zeros(6), np.full((2, 3, 6), np.nan))
    with pytest.raises(BadValueError, match="q is .*to be overwritten"):
        servo.run([0.0] * 6, np.zeros(6), wanted)
    with pytest.raises(NonFiniteError, match="qd"):
        servo.run(np.zeros(6), np.full(6, np.inf), wanted)
    with pytest.raises(WrongSizeError, match="q"):
        servo.run(np.zeros(5), np.zeros(6), wanted)
    with pytest.raises(WrongSizeError, match="observed"):
        servo.run(np.zeros(6), np.zeros(6), wanted, observed=np.zeros(5))
