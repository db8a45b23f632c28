"""A parallel robot under a controller of its drives: it tracks, sticks, saturates, and tells."""

import copy
import dataclasses

import numpy as np
import pytest

from robomech_ros.dynamics import ControlledArm
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.parallel import ParallelDynamics, list_parallel, load_parallel
from robomech_ros.robots import Body, load_robot

LOAD = Body(1.0, [0, 0, 0.02], 1e-3 * np.eye(3))


def dynamics_of(name):
    return ParallelDynamics(load_parallel(name).mechanism)


def with_friction(mechanism, driven, passive):
    """Return all drives, and all passive joints, the same friction."""
    limbs = []
    for limb in mechanism.limbs:
        drives = [
            dataclasses.replace(drive, **(driven if name in mechanism.actuated else passive))
            for name, drive in zip(limb.chain.joint_names, limb.chain.drives, strict=True)
        ]
        limbs.append(
            dataclasses.replace(limb, chain=dataclasses.replace(limb.chain, drives=tuple(drives)))
        )
    other = copy.copy(mechanism)
    other.limbs = tuple(limbs)
    return other


def small_sines(dynamics, seconds, size=0.02):
    """Move all drives to and fro about home; wanted (k, 3, m)."""
    t = np.arange(round(1000 * seconds))[:, None] * 1e-3
    w = np.linspace(3.0, 5.0, len(dynamics.drive_names))
    home = dynamics.mechanism.home()[dynamics.drives_at]
    return np.stack(
        (
            home + size * (1.0 - np.cos(w * t)),
            size * w * np.sin(w * t),
            size * w**2 * np.cos(w * t),
        ),
        axis=1,
    )


def run(servo, dynamics, wanted, **given):
    q, qd = dynamics.mechanism.home(), wanted[0, 1].copy()
    motion = servo.run(q, qd, wanted, **given)
    error = motion.q[:-1, dynamics.drives_at] - wanted[1 : len(motion.q), 0]
    return motion, np.abs(error).max()


SHOWN = "delta", "hexapod", "planar_3rrr", "tripod_3prs"


@pytest.mark.parametrize(
    ("name", "control"),
    [
        *((name, "computed-torque") for name in list_parallel()),
        *((name, "pd-gravity") for name in SHOWN),
        *(
            pytest.param(name, "pd-gravity", marks=pytest.mark.long)
            for name in list_parallel()
            if name not in SHOWN
        ),
    ],
)
def test_every_robot_of_the_library_is_tracked_with_its_loops_closed(name, control):
    dynamics = dynamics_of(name)
    wanted = small_sines(dynamics, 0.5)
    motion, error = run(ControlledArm(dynamics, control=control), dynamics, wanted)
    assert motion.reason == "" and not motion.singular
    assert error < {"computed-torque": 1e-4, "pd-gravity": 1e-2}[control]
    assert dynamics.mechanism.loop_errors(motion.q).max() < 1e-10
    assert motion.q.shape == (500, dynamics.mechanism.n)
    assert motion.qd.shape == motion.effort.shape == (500, len(dynamics.drive_names))


@pytest.mark.parametrize("name", ["delta", "hexapod", "planar_3rrr"])
def test_it_moves_as_forward_dynamics_say_under_the_same_law(name):
    """In steps whose rates at the end give the values, without friction."""
    mechanism = with_friction(
        load_parallel(name).mechanism,
        {"viscous": 0.0, "coulomb": 0.0},
        {"viscous": 0.0, "coulomb": 0.0},
    )
    dynamics, drives = ParallelDynamics(mechanism), mechanism.drive_index
    q, rates = mechanism.home(), np.zeros(mechanism.dof)
    goal = q[drives] + np.linspace(0.01, 0.02, mechanism.dof)
    kp, kd = 400.0 * np.ones(mechanism.dof), 20.0 * np.ones(mechanism.dof)
    wanted = np.zeros((200, 3, mechanism.dof))
    wanted[:, 0] = goal
    servo = ControlledArm(dynamics, control="pd-gravity", kp=kp, kd=kd)
    motion = servo.run(q.copy(), rates.copy(), wanted)
    for _ in wanted:
        tau = kp * (goal - q[drives]) - kd * rates + dynamics.gravity(q)
        rates = rates + 1e-3 * dynamics.forward(q, rates, tau)
        q = mechanism.close(q[drives] + 1e-3 * rates, q).q
    assert np.abs(rates).max() > 1e-3
    np.testing.assert_allclose(motion.q[-1], q, atol=1e-9)
    np.testing.assert_allclose(motion.qd[-1], rates, atol=1e-8)


def test_friction_of_passive_joints_takes_the_energy_that_it_should():
    """A robot let go in weightlessness: what it loses is what friction takes."""
    passive = {"viscous": 0.002, "coulomb": 0.005}
    mechanism = with_friction(
        load_parallel("planar_3rrr").mechanism, {"viscous": 0.0, "coulomb": 0.0}, passive
    )
    dynamics = ParallelDynamics(mechanism)
    free = {"kp": np.zeros(3), "kd": np.zeros(3), "control": "pd-gravity"}
    servo = ControlledArm(dynamics, gravity=[0.0, 0.0, 0.0], period=2e-4, **free)
    q, rates = mechanism.home(), np.array([0.6, -0.3, 0.2])
    before = dynamics.kinetic_energy(q, rates)
    motion = servo.run(q, rates, np.zeros((1500, 3, 3)))
    assert motion.reason == "" and np.abs(motion.effort).max() == 0.0
    lost = dynamics.friction(motion.q, motion.qd)
    heat = 2e-4 * (lost * motion.qd).sum()
    after = dynamics.kinetic_energy(motion.q[-1], motion.qd[-1])
    assert before - after > 0.05 * before
    assert heat == pytest.approx(before - after, rel=2e-2)


def test_dry_friction_of_drives_holds_it_where_it_is():
    mechanism = with_friction(load_parallel("delta").mechanism, {"coulomb": 20.0}, {"viscous": 0.0})
    dynamics = ParallelDynamics(mechanism)
    # The controller knows nothing of the load, and corrects nothing.
    idle = {"control": "pd-gravity", "kp": np.zeros(3), "kd": np.zeros(3)}
    servo = ControlledArm(dynamics, dynamics.with_payload(LOAD), **idle)
    q, rates = mechanism.home(), np.zeros(3)
    servo.run(q, rates, np.zeros((200, 3, 3)))
    np.testing.assert_allclose(q, mechanism.home(), atol=1e-12)
    assert not rates.any()
    heavy = Body(100.0, [0, 0, 0], np.eye(3))
    ControlledArm(dynamics, dynamics.with_payload(heavy), **idle).run(q, rates, np.zeros((9, 3, 3)))
    assert rates.all()


def test_a_payload_that_the_model_does_not_know_is_learned():
    dynamics = dynamics_of("delta")
    wanted = np.zeros((1500, 3, 3))
    wanted[:, 0] = dynamics.mechanism.home()[dynamics.drives_at]
    errors = []
    for observer in (0.0, 500.0):
        servo = ControlledArm(dynamics, dynamics.with_payload(LOAD), observer=observer)
        motion, _ = run(servo, dynamics, wanted)
        assert motion.reason == ""
        errors.append(np.abs(motion.q[-1, dynamics.drives_at] - wanted[-1, 0]).max())
    assert errors[0] > 1e-3 > 20.0 * errors[1]


def test_drives_saturate_stand_at_stops_and_are_held_by_brakes():
    dynamics = dynamics_of("hexapod")
    wanted = small_sines(dynamics, 0.3)
    wanted[:, 0] += 0.5
    held = np.array([True, False, False, False, False, False])
    motion, _ = run(ControlledArm(dynamics), dynamics, wanted, held=held)
    lengths = motion.q[:, dynamics.drives_at]
    assert motion.saturated.any()
    assert np.ptp(lengths[:, 0]) == 0.0
    assert lengths.max() <= 0.95 + 1e-9


def test_it_stops_before_the_singular_posture_in_which_its_mode_ends():
    dynamics = dynamics_of("planar_3rrr")
    mechanism = dynamics.mechanism
    home, drives = mechanism.home(), mechanism.drive_index
    # With the first drive where it is there is a singular posture in the way of the others.
    change = np.array([0.0, 1.6647, -0.4024])
    assert mechanism.close(home[drives] + change, home).status
    s = np.linspace(0.0, 1.0, 3000)[:, None]
    wanted = np.zeros((3000, 3, 3))
    wanted[:, 0] = home[drives] + s**2 * (3.0 - 2.0 * s) * change
    wanted[:, 1] = 6.0 * s * (1.0 - s) * change / 3.0
    q = home.copy()
    motion = ControlledArm(dynamics).run(q, np.zeros(3), wanted)
    assert motion.singular and "singular posture" in motion.reason
    assert mechanism.loop_errors(q).max() < 1e-10
    np.testing.assert_array_equal(q, motion.q[-1])
    # In another mode the platform would move the other way: that sign changes through infinity,
    # and through 0 only where a limb is outstretched.
    plane = np.linalg.det(mechanism.twist_matrix(np.vstack([home, motion.q]))[:, [2, 3, 4]])
    changes = np.sign(plane[1:]) != np.sign(plane[:-1])
    assert np.abs(plane[1:][changes]).max() < 1.0 < 100.0 < np.abs(plane).max()


def test_steps_within_a_period_change_little():
    dynamics = dynamics_of("delta")
    wanted = small_sines(dynamics, 0.2)
    ends = [
        run(ControlledArm(dynamics, substeps=k, observer=500.0), dynamics, wanted)[0].q[-1]
        for k in (1, 4)
    ]
    np.testing.assert_allclose(*ends, atol=1e-4)
    assert np.abs(ends[0] - ends[1]).max() > 0.0


def test_other_robots_and_wrong_states_are_refused():
    delta = dynamics_of("delta")
    with pytest.raises(BadValueError, match="a chain or no chain"):
        ControlledArm(delta, load_robot("planar3r"))
    with pytest.raises(WrongSizeError, match="15, as many as of the model"):
        ControlledArm(delta, dynamics_of("hexapod"))
    with pytest.raises(BadValueError, match="the limbs of the model"):
        ControlledArm(dynamics_of("sgp_6_3"), dynamics_of("sgp_3_3"))
    with pytest.raises(WrongSizeError, match="q"):
        ControlledArm(delta).run(np.zeros(3), np.zeros(3), np.zeros((1, 3, 3)))
