"""Grasp matrix, internal forces, form and force closure."""

import numpy as np
import pytest
from grasps import CUBE, disc, on_sphere, opposed, random_sphere
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from robomech_ros.hands import (
    Contact,
    grasp_matrix,
    internal_forces,
    is_force_closed,
    is_form_closed,
)


def test_angeles_grasp_matrix_of_point_contacts():
    """Blocks [CPM(p - o); 1], moments first."""
    rng = np.random.default_rng(1)
    contacts, o = random_sphere(rng, 4, 0.5), rng.normal(size=3)
    f = rng.normal(size=(4, 3))
    r = np.array([one.position for one in contacts]) - o
    wrench = np.concatenate([np.cross(r, f).sum(axis=0), f.sum(axis=0)])
    G = grasp_matrix(contacts, o)
    assert G.shape == (6, 12)
    assert np.allclose(G @ f.ravel(), wrench, atol=1e-14)


def test_columns_of_the_other_models():
    p, n = np.array([0.2, 0.1, 0.3]), np.array([0.0, 0.6, -0.8])
    G = grasp_matrix([Contact(p, n, "frictionless")], np.zeros(3))
    assert np.allclose(G[:, 0], [*np.cross(p, n), *n])
    G = grasp_matrix([Contact(p, n, "soft", 0.5, 0.1)], np.zeros(3))
    assert G.shape == (6, 4)
    assert np.allclose(G[:, 3], [*n, 0.0, 0.0, 0.0])
    G = grasp_matrix([Contact(p[:2], [1.0, 0.0], "point", 0.5)], [0.0, 0.0])
    assert np.allclose(G, [[-0.1, 0.2], [1.0, 0.0], [0.0, 1.0]])


@pytest.mark.parametrize("model", ["frictionless", "point", "soft"])
def test_internal_forces_are_in_the_null_space(model):
    contacts = random_sphere(np.random.default_rng(2), 7, 0.5, model, 0.1)
    inner = internal_forces(contacts)
    G = grasp_matrix(contacts, np.array([0.3, -0.2, 0.1]))
    assert inner.shape[1] == G.shape[1] - np.linalg.matrix_rank(G)
    assert np.abs(G @ inner).max() < 1e-12
    assert np.allclose(inner.T @ inner, np.eye(inner.shape[1]), atol=1e-12)


def test_two_frictionless_opposed_contacts_are_not_closed():
    assert not is_force_closed(opposed("frictionless"))
    assert not is_force_closed(disc(2, 0.0, "frictionless"))


def test_soft_finger_pair_is_closed_and_point_pair_not():
    assert is_force_closed(opposed("soft", 0.5, 0.1))
    assert not is_force_closed(opposed("soft", 0.5, 0.0))
    assert not is_force_closed(opposed("point", 0.5))


@pytest.mark.parametrize("count", [2, 3, 4, 7])
def test_discs_are_closed_by_any_friction_and_open_without(count):
    assert is_force_closed(disc(count, 1e-3))
    assert not is_force_closed(disc(count, 0.0))


@pytest.mark.parametrize("margin", [1e-3, 1e-6])
def test_closure_is_strict_at_the_rim_of_the_cones(margin):
    """A pair in the plane is closed if and only if the line between is inside both cones."""
    tilt = 0.3
    normals = [[np.cos(tilt), np.sin(tilt)], [-np.cos(tilt), np.sin(tilt)]]
    for sign in (1.0, -1.0):
        mu = np.tan(tilt) + sign * margin
        pair = [Contact(p, n, "point", mu) for p, n in zip([[-1, 0], [1, 0]], normals, strict=True)]
        assert is_force_closed(pair) == (sign > 0)


def surrounded(contacts, edges):
    """Whether pyramids inside the cones surround the origin, by a linear program."""
    turns = 2.0 * np.pi * np.arange(edges) / edges
    rays = []
    for one in contacts:
        for a in turns:
            f = one.normal + one.friction * (
                np.cos(a) * one.tangents[0] + np.sin(a) * one.tangents[1]
            )
            rays.append([*np.cross(one.position, f), *f])
    A = np.array(rays).T
    count = A.shape[1]
    # The largest least share of a ray with all shares together 1.
    A_eq = np.vstack([np.hstack([A, np.zeros((6, 1))]), [*np.ones(count), 0.0]])
    A_ub = np.hstack([-np.eye(count), np.ones((count, 1))])
    cost = [*np.zeros(count), -1.0]
    found = linprog(
        cost, A_ub, np.zeros(count), A_eq, [*np.zeros(6), 1.0], [(0, None)] * count + [(None, None)]
    )
    full = np.linalg.matrix_rank(A) == 6
    return full and found.status == 0 and -found.fun > 1e-9


def test_force_closure_agrees_with_linear_programs():
    rng = np.random.default_rng(3)
    answers = []
    for _ in range(40):
        mu = rng.uniform(0.1, 1.0)
        contacts = random_sphere(rng, int(rng.integers(3, 7)), mu)
        wider = [Contact(c.position, c.normal, "point", mu / np.cos(np.pi / 24)) for c in contacts]
        inside, outside = surrounded(contacts, 24), surrounded(wider, 24)
        answer = is_force_closed(contacts)
        assert inside <= answer <= outside
        answers.append(answer)
    assert {True, False} == set(answers)


def test_closure_does_not_depend_on_frame_order_and_size():
    rng = np.random.default_rng(4)
    for _ in range(20):
        contacts = random_sphere(rng, 4, 0.5)
        R, shift, size = (
            Rotation.random(random_state=rng).as_matrix(),
            rng.normal(size=3),
            10.0 ** rng.uniform(-3, 3),
        )
        moved = [
            Contact(size * (R @ c.position + shift), R @ c.normal, "point", 0.5) for c in contacts
        ]
        assert is_force_closed(contacts) == is_force_closed(moved[::-1])


def test_form_closure_of_a_square_and_of_a_cube():
    """Two on each side, off its middle, turned the same way round: Reuleaux's case."""
    corners = [([1, 0.5], [-1, 0]), ([-1, -0.5], [1, 0]), ([0.5, -1], [0, 1]), ([-0.5, 1], [0, -1])]
    same = [Contact(p, n, "point", 0.5) for p, n in corners]
    assert not is_form_closed(same)
    against = [*same[:2], *(Contact([-x, y], n, "point", 0.5) for (x, y), n in corners[2:])]
    assert is_form_closed(against)
    assert not is_form_closed(against[:3])
    assert not is_form_closed(on_sphere(CUBE, 0.5))


def test_seven_frictionless_contacts_can_hold_a_body_and_six_cannot():
    rng = np.random.default_rng(5)
    found = 0
    for _ in range(2000):
        p, n = rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
        contacts = [Contact(a, b, "frictionless") for a, b in zip(p, n, strict=True)]
        if is_form_closed(contacts):
            found += 1
            assert not any(is_form_closed(contacts[:k] + contacts[k + 1 :]) for k in range(7))
    assert found >= 1
