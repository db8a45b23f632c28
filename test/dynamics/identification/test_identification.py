"""Identification: base parameters and friction from torques, and bodies that there can be."""

from dataclasses import replace

import numpy as np
import pytest
from formulation_arms import furnished, relative, states

from robomech_ros.dynamics.formulations.lagrange import inverse_dynamics_by_lagrange
from robomech_ros.dynamics.friction import friction_torque
from robomech_ros.dynamics.identification.consistent_fit import consistent_fit
from robomech_ros.dynamics.identification.fit import excitation, identify
from robomech_ros.dynamics.model import body_parameters
from robomech_ros.dynamics.pseudo_inertias import (
    bodies_from_parameters,
    is_physically_consistent,
    nearest_consistent,
    parameters_from_pseudo_inertia,
    pseudo_inertia,
)
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.robots import Drive, load_robot

DOWN = (0.0, 0.0, -9.81)


def arm_of(name, seed=1):
    """A robot with random bodies, and with friction that is linear in its coefficients."""
    arm = furnished(load_robot(name), seed, drives=True)
    drives = tuple(
        Drive(one.viscous, one.coulomb, rotor_inertia=one.rotor_inertia, gear_ratio=one.gear_ratio)
        for one in arm.drives
    )
    return replace(arm, drives=drives)


def drive_torques(arm, q, qd, qdd):
    return inverse_dynamics_by_lagrange(arm, q, qd, qdd, gravity=DOWN) + friction_torque(arm, qd)


def measured(arm, count, noise, seed=0):
    q, qd, qdd = states(arm, count, seed)
    tau = drive_torques(arm, q, qd, qdd)
    return q, qd, qdd, tau + noise * np.random.default_rng(seed).normal(size=q.shape)


@pytest.mark.parametrize(("robot", "rank"), [("planar3r", 7), ("scara", 8), ("puma560", 36)])
def test_torques_without_noise_give_the_parameters_back(robot, rank):
    arm = arm_of(robot)
    found = identify(arm, *measured(arm, 60, 0.0), gravity=DOWN)
    expected = found.base.combination @ body_parameters(arm).ravel()
    assert found.base.rank == rank
    assert relative(found.base_values, expected) < 1e-10
    np.testing.assert_allclose(found.viscous, [one.viscous for one in arm.drives], rtol=1e-9)
    np.testing.assert_allclose(found.coulomb, [one.coulomb for one in arm.drives], rtol=1e-9)
    # The bodies known before have these base parameters, so they are what is nearest to them.
    np.testing.assert_allclose(found.parameters, body_parameters(arm), atol=1e-9)
    assert found.consistent.all()


def test_standard_errors_tell_how_far_the_values_are_off():
    arm = arm_of("scara")
    errors, deviations = [], []
    for seed in range(20):
        found = identify(arm, *measured(arm, 100, 0.3, seed), gravity=DOWN)
        expected = found.base.combination @ body_parameters(arm).ravel()
        errors.append((found.base_values - expected) / found.standard_errors[: found.base.rank])
        deviations.append(found.deviations)
    assert 0.8 < np.sqrt(np.mean(np.square(errors))) < 1.2
    np.testing.assert_allclose(np.mean(deviations, axis=0), 0.3, rtol=0.1)


def test_joints_with_less_noise_count_for_more():
    arm, noise = arm_of("scara"), np.array([5.0, 0.01, 0.01, 0.01])
    q, qd, qdd, tau = measured(arm, 100, noise)
    weighted = identify(arm, q, qd, qdd, tau, gravity=DOWN, deviations=noise)
    by_itself = identify(arm, q, qd, qdd, tau, gravity=DOWN)
    alike = identify(arm, q, qd, qdd, tau, gravity=DOWN, deviations=np.ones(4))
    expected = weighted.base.combination @ body_parameters(arm).ravel()
    off = [
        float(np.linalg.norm(one.base_values[1:] - expected[1:]))
        for one in (weighted, by_itself, alike)
    ]
    assert max(off[:2]) < 0.2 * off[2]


@pytest.mark.parametrize("noise", [1e-3, 1.0])
def test_consistent_bodies_meet_other_motions(noise):
    arm = arm_of("scara")
    known = replace(arm, bodies=furnished(arm, 99).bodies)
    found = identify(known, *measured(arm, 200, noise), gravity=DOWN)
    fit = consistent_fit(found)
    assert fit.converged and is_physically_consistent(fit.parameters).all() and fit.deviation < 2.0
    q, qd, qdd, tau = measured(arm, 50, 0.0, seed=5)
    predicted = drive_torques(fit.chain, q, qd, qdd)
    assert np.sqrt(np.mean((predicted - tau) ** 2)) < 0.5 * noise


def test_bodies_are_found_where_none_were_known():
    arm = arm_of("planar3r")
    data = measured(arm, 100, 0.1)
    found = identify(replace(arm, bodies=()), *data, gravity=DOWN)
    fit = consistent_fit(found)
    assert is_physically_consistent(fit.parameters).all() and fit.deviation < 2.0


def with_less_load(arm, q, qd, qdd, tau, mass):
    """Torques less those of a mass (kg) in the place of the last body: bodies must be negative."""
    last = replace(arm.bodies[3], mass=mass)
    load = replace(arm, bodies=(*arm.bodies[:3], last), drives=())
    less = inverse_dynamics_by_lagrange(load, q, qd, qdd, gravity=DOWN)
    return (
        tau - less + inverse_dynamics_by_lagrange(replace(arm, drives=()), q, qd, qdd, gravity=DOWN)
    )


def test_bodies_are_found_that_meet_data_of_negative_ones():
    """Other bodies have the same base parameters; a search that ends elsewhere is at fault."""
    arm = arm_of("scara")
    q, qd, qdd, tau = measured(arm, 100, 1e-3)
    found = identify(arm, q, qd, qdd, with_less_load(arm, q, qd, qdd, tau, 20.0), gravity=DOWN)
    assert not found.consistent.all()
    for seed in (1, 2):
        fit = consistent_fit(replace(found, chain=replace(arm, bodies=furnished(arm, seed).bodies)))
        assert fit.converged and fit.deviation < 1e-3
        assert is_physically_consistent(fit.parameters).all()
        met = found.base.combination @ fit.parameters.ravel()
        np.testing.assert_allclose(met, found.base_values, atol=1e-9)


def test_data_that_no_bodies_can_give_are_met_as_well_as_bodies_can():
    arm = arm_of("scara")
    q, qd, qdd, tau = measured(arm, 100, 1e-3)
    wrong = with_less_load(arm, q, qd, qdd, tau, 60.0)
    found = identify(arm, q, qd, qdd, wrong, gravity=DOWN, deviations=np.ones(4))
    fits = [
        consistent_fit(replace(found, chain=replace(arm, bodies=furnished(arm, seed).bodies)))
        for seed in (1, 2)
    ]
    for fit in fits:
        assert is_physically_consistent(fit.parameters).all() and fit.converged
    assert fits[0].deviation > 10.0
    assert fits[1].deviation == pytest.approx(fits[0].deviation, rel=1e-4)


def test_excitation_tells_good_motions_from_bad_ones():
    arm = arm_of("puma560")
    q, qd, qdd = states(arm, 60)
    good, slight = (excitation(arm, s * q, s * qd, s * qdd, gravity=DOWN) for s in (1.0, 0.1))
    found = identify(arm, *measured(arm, 60, 0.0), gravity=DOWN, deviations=np.ones(6))
    assert good < 10.0 < slight
    np.testing.assert_allclose(good, found.condition, rtol=1e-9)
    assert excitation(arm, 0 * q, qd, qdd, gravity=DOWN) == np.inf


def test_wrong_data_are_refused():
    arm = arm_of("planar3r")
    q, qd, qdd, tau = measured(arm, 30, 0.0)
    with pytest.raises(BadValueError, match="number of parameters that the motion shows is"):
        identify(arm, 0 * q, 0 * qd, qdd, tau)
    with pytest.raises(WrongSizeError, match="more than 4 states"):
        identify(arm, q[:4], qd[:4], qdd[:4], tau[:4])
    with pytest.raises(WrongSizeError, match=r"expected \(m, 3\)"):
        identify(arm, q[0], qd[0], qdd[0], tau[0])
    with pytest.raises(BadValueError, match="3 positive numbers"):
        identify(arm, q, qd, qdd, tau, deviations=[1.0, 0.0, 1.0])
    with pytest.raises(WrongSizeError, match="tau has shape"):
        identify(arm, q, qd, qdd, tau[:5])


def test_pseudo_inertias_are_inverted():
    parameters = body_parameters(arm_of("puma560"))
    J = pseudo_inertia(parameters)
    assert (np.linalg.eigvalsh(J) > 0.0).all()
    np.testing.assert_allclose(parameters_from_pseudo_inertia(J), parameters, atol=1e-15)
    again = body_parameters(
        replace(load_robot("puma560"), bodies=bodies_from_parameters(parameters))
    )
    np.testing.assert_allclose(again, parameters, atol=1e-14)


def test_the_nearest_consistent_body_is_nearer_than_others():
    rng = np.random.default_rng(2)
    wrong = rng.normal(size=(50, 10))
    assert not is_physically_consistent(wrong).any()
    clipped = nearest_consistent(wrong)
    assert is_physically_consistent(clipped).all()
    distance = np.linalg.norm(pseudo_inertia(clipped) - pseudo_inertia(wrong), axis=(-2, -1))
    for _ in range(20):
        root = np.linalg.cholesky(pseudo_inertia(clipped)) @ (
            np.eye(4) + 0.1 * rng.normal(size=(50, 4, 4))
        )
        other = parameters_from_pseudo_inertia(root @ np.swapaxes(root, -1, -2))
        further = np.linalg.norm(pseudo_inertia(other) - pseudo_inertia(wrong), axis=(-2, -1))
        assert (further > distance).all()
    with pytest.raises(BadValueError, match="least"):
        nearest_consistent(wrong, least=0.0)
