"""Accelerations, moving axes and bodies against differences and against energy."""

import numpy as np
import pinocchio
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros import spatial
from robomech_ros.errors import BadValueError

RNG = np.random.default_rng(1)
W, DW, A, P, V, R = RNG.normal(size=(6, 30, 3))


def test_the_angular_acceleration_matrix_has_the_invariants_of_the_book():
    matrix = spatial.angular_acceleration_matrix(W, DW)
    vect, trace = spatial.linear_invariants(matrix)
    np.testing.assert_allclose(vect, DW, atol=1e-14)
    np.testing.assert_allclose(trace, -2.0 * np.sum(W * W, -1), atol=1e-13)
    np.testing.assert_allclose(
        np.linalg.det(matrix), -np.sum(np.cross(W, DW) ** 2, axis=-1), atol=1e-12
    )


def test_the_pole_has_no_acceleration():
    pole = spatial.acceleration_pole(P, A, W, DW)
    left = spatial.point_acceleration(pole, P, A, W, DW)
    np.testing.assert_allclose(left, 0.0, atol=1e-11)
    assert np.isnan(spatial.acceleration_pole(P, A, W, 2.0 * W)).all()
    assert np.isnan(spatial.acceleration_pole(P[0], A[0], [0, 0, 0], DW[0])).all()
    assert np.isnan(spatial.acceleration_pole(P[0], A[0], [0, 0, 0], [0, 0, 0])).all()
    # In a plane: a line of points, of which the nearest is found.
    level = spatial.acceleration_pole([1.0, 0.0, 0.3], [0.0, 2.0, 0.0], [0, 0, 2.0], [0, 0, 1.0])
    planar = np.linalg.solve([[-4.0, -1.0], [1.0, -4.0]], [0.0, -2.0])
    np.testing.assert_allclose(level, [1.0 + planar[0], planar[1], 0.3], atol=1e-12)
    assert np.isnan(
        spatial.acceleration_pole([0, 0, 0], [0, 0, 1.0], [0, 0, 2.0], [0, 0, 1.0])
    ).all()


def test_motion_in_moving_axes_is_the_derivative_of_the_position():
    def position(t, k):
        turn = spatial.matrix_from_rotation_vector(W[k] * t + 0.5 * DW[k] * t * t)
        inside = P[k] + V[k] * t + 0.5 * A[k] * t * t
        return R[k] * t + turn @ inside

    h = 1e-3
    for k in range(5):
        rows = [position(i * h, k) for i in range(-2, 3)]
        found = spatial.moving_axes_motion(P[k], V[k], A[k], W[k], DW[k], R[k])
        velocity = (rows[0] - 8 * rows[1] + 8 * rows[3] - rows[4]) / (12 * h)
        change = (-rows[0] + 16 * rows[1] - 30 * rows[2] + 16 * rows[3] - rows[4]) / (12 * h * h)
        np.testing.assert_allclose(found.velocity, velocity, atol=1e-9)
        np.testing.assert_allclose(found.acceleration, change, atol=1e-7)
        np.testing.assert_allclose(found.coriolis, 2.0 * np.cross(W[k], V[k]), atol=1e-14)


def bodies():
    mass = RNG.uniform(0.1, 5.0, 30)
    axes = Rotation.random(30, rng=RNG).as_matrix()
    moments = RNG.uniform(1.0, 1.5, (30, 3))
    return mass, axes * moments[:, None, :] @ np.swapaxes(axes, -1, -2)


def test_bodies_move_as_pinocchio_moves_them():
    mass, inertia = bodies()
    t, rate = RNG.normal(size=(2, 30, 6))
    wrench = spatial.newton_euler_wrench(mass, inertia, t, rate)
    momentum = spatial.momentum_screw(mass, inertia, t)
    energy = spatial.twist_kinetic_energy(mass, inertia, t)
    M, dyad = spatial.inertia_dyad(mass, inertia), spatial.angular_velocity_dyad(t[:, :3])
    by_matrices = M @ rate[..., None] + dyad @ M @ t[..., None]
    np.testing.assert_allclose(wrench, by_matrices[..., 0], atol=1e-13)
    for k in range(30):
        body = pinocchio.Inertia(mass[k], np.zeros(3), inertia[k])
        motion = pinocchio.Motion(t[k, 3:], t[k, :3])
        theirs = body * motion
        np.testing.assert_allclose(momentum[k, :3], theirs.angular, atol=1e-13)
        np.testing.assert_allclose(momentum[k, 3:], theirs.linear, atol=1e-13)
        assert energy[k] == pytest.approx(0.5 * t[k] @ momentum[k])
        # Theirs is in axes that move with the body's point: less omega x v.
        spatial_rate = pinocchio.Motion(rate[k, 3:] - np.cross(t[k, :3], t[k, 3:]), rate[k, :3])
        force = body * spatial_rate + motion.cross(theirs)
        np.testing.assert_allclose(wrench[k, :3], force.angular, atol=1e-12)
        np.testing.assert_allclose(wrench[k, 3:], force.linear, atol=1e-12)


def test_inertia_about_a_point_is_that_of_point_masses():
    r = RNG.normal(size=(12, 3))
    m = RNG.uniform(0.1, 2.0, 12)
    about_origin = spatial.inertia_of_point_mass(m, r).sum(axis=0)
    centre = m @ r / m.sum()
    own = spatial.inertia_of_point_mass(m, r - centre).sum(axis=0)
    moved = spatial.inertia_about_point(m.sum(), own, centre, [0, 0, 0])
    np.testing.assert_allclose(moved, about_origin, atol=1e-12)
    with pytest.raises(BadValueError, match="symmetric"):
        spatial.inertia_about_point(1.0, np.arange(9.0).reshape(3, 3), [0, 0, 0], [0, 0, 1])
    with pytest.raises(BadValueError, match="mass is -1"):
        spatial.inertia_dyad(-1.0, np.eye(3))


def test_principal_axes_are_those_about_which_a_body_turns_without_wobbling():
    rng = np.random.default_rng(8)
    r = rng.normal(size=(5, 10, 4, 3))
    own = spatial.inertia_of_point_mass(1.0, r).sum(axis=2)
    moments, axes = spatial.principal_inertia(own)
    assert (np.diff(moments, axis=-1) >= 0.0).all()
    np.testing.assert_allclose(own @ axes, axes * moments[..., None, :], atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(axes), 1.0)
    for k in range(3):
        spin = np.zeros((5, 10, 6))
        spin[..., :3] = axes[..., k]
        assert np.abs(spatial.newton_euler_wrench(2.0, own, spin, np.zeros(6))).max() < 1e-12
    assert (moments[..., 2] <= moments[..., 0] + moments[..., 1] + 1e-12).all()
    assert spatial.principal_inertia(1e200 * own[0, 0]).moments == pytest.approx(
        1e200 * moments[0, 0]
    )
    assert not spatial.principal_inertia(np.zeros((3, 3))).moments.any()


def test_radii_of_gyration_of_a_box():
    sides, mass = np.array([0.2, 0.5, 0.9]), 3.0
    R = spatial.matrix_from_rotation_vector([0.3, -0.4, 0.8])
    squares = (sides**2).sum() - sides**2
    own = R @ np.diag(mass * squares / 12.0) @ R.T
    found = spatial.radii_of_gyration(mass, 0.5 * (own + own.T))
    np.testing.assert_allclose(found, np.sort(np.sqrt(squares / 12.0)))
    with pytest.raises(BadValueError, match="mass is 0.0, expected more than 0 kg"):
        spatial.radii_of_gyration(0.0, np.eye(3))
    with pytest.raises(BadValueError, match="moment of inertia is -1.0, expected at least 0"):
        spatial.radii_of_gyration(1.0, np.diag([-1.0, 2.0, 2.0]))
    with pytest.raises(BadValueError, match="largest of inertia is 1e.308"):
        spatial.principal_inertia(np.full((3, 3), 1e308))
    np.testing.assert_allclose(spatial.radii_of_gyration(1e-300, 1e300 * np.eye(3)), 1e300)
