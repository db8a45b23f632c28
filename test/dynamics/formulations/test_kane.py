"""Kane's equations: partial velocities are the columns of the twist-shaping matrix."""

import numpy as np
import pytest
from formulation_arms import GRAVITY, furnished, relative, states

from robomech_ros.dynamics.formulations.kane import (
    forward_dynamics_by_kane,
    inverse_dynamics_by_kane,
    partial_velocities,
)
from robomech_ros.dynamics.formulations.orthogonal_complement import natural_orthogonal_complement
from robomech_ros.dynamics.posed_bodies import reflected_inertias
from robomech_ros.kinematics.forward_uncompiled import link_transforms
from robomech_ros.robots import Body, chain_from_dh


@pytest.fixture(params=("RRRRRR", "RPRPRR", "PRP"))
def arm(request, random_chain):
    types = ["RP".index(kind) for kind in request.param]
    return furnished(random_chain(9, len(types), types), 1, drives=True)


def test_partial_velocities_are_the_columns_of_the_twist_shaping_matrix(arm):
    q, qd, _ = states(arm, 10)
    partial = partial_velocities(arm, q)
    R = link_transforms(arm, q)[..., :-1, :3, :3]
    T = natural_orthogonal_complement(arm, q, qd).T.reshape(10, arm.n, 6, arm.n)
    turned = (
        np.einsum("...iab,...ijb->...iaj", R, one) for one in (partial.angular, partial.linear)
    )
    np.testing.assert_allclose(np.concatenate(tuple(turned), axis=-2), T, atol=1e-12)


def test_rotors_are_added_to_the_rigid_bodies_and_friction_is_not(arm):
    bare = furnished(arm, 1)
    q, qd, qdd = states(arm, 10)
    whole, bodies = (
        inverse_dynamics_by_kane(one, q, qd, qdd, gravity=GRAVITY) for one in (arm, bare)
    )
    assert relative(whole, bodies + reflected_inertias(arm) * qdd) < 1e-12


def test_an_arm_let_go_falls_with_its_weight():
    # A rod of 1 m and 3 kg on a horizontal axis, lying level: 3 g / (2 l).
    rod = Body(3.0, [-0.5, 0.0, 0.0], np.diag([0.0, 0.25, 0.25]))
    arm = chain_from_dh([1.0], [0.0], [0.0], bodies=[rod])
    acceleration = forward_dynamics_by_kane(arm, [0.0], [0.0], [0.0], gravity=[0.0, -9.81, 0.0])
    np.testing.assert_allclose(acceleration, [-1.5 * 9.81], rtol=1e-14)
