"""The smallest contact forces, and the direction in which a load cannot be held."""

import sys

import numpy as np
import pytest
from grasps import on_sphere, opposed, random_sphere
from scipy.optimize import linprog

from robomech_ros.hands import (
    ConicSolverUnavailableError,
    Contact,
    ForceStatus,
    contact_forces,
    grasp_matrix,
)

DOWN = [0.0, 0.0, 0.0, 0.0, 0.0, -1.0]


def excess(contacts, found):
    """How far forces are outside their cones."""
    worst = -np.inf
    for one, force, torsion in zip(contacts, found.forces, found.torsions, strict=True):
        normal = force @ one.normal
        across = np.linalg.norm(force - normal * one.normal)
        if one.model == "frictionless":
            worst = max(worst, across, -normal)
        elif one.model == "soft":
            worst = max(worst, np.hypot(across / one.friction, torsion / one.torsional) - normal)
        else:
            worst = max(worst, across - one.friction * normal)
    return worst


@pytest.mark.parametrize("model", ["point", "soft"])
@pytest.mark.parametrize("smallest", ["largest", "total"])
def test_forces_balance_the_load_inside_their_cones(model, smallest):
    rng = np.random.default_rng(9)
    held = 0
    for _ in range(15):
        contacts = random_sphere(rng, int(rng.integers(4, 7)), 0.9, model, 0.2)
        load, o = 30.0 * rng.normal(size=6), rng.normal(size=3)
        found = contact_forces(contacts, load, origin=o, smallest=smallest)
        if found.status is not ForceStatus.HELD:
            continue
        held += 1
        weight = np.linalg.norm(load)
        assert np.abs(grasp_matrix(contacts, o) @ found.components + load).max() < 1e-9 * weight
        assert excess(contacts, found) < 1e-7 * weight
    assert held >= 5


def test_optima_that_can_be_computed_by_hand():
    """A pair that holds a weight by friction, and three fingers that share one."""
    found = contact_forces(opposed("point", 0.5), DOWN, smallest="total")
    assert found.total == pytest.approx(2.0, abs=1e-7)
    found = contact_forces(opposed("point", 0.5), DOWN)
    assert found.largest == pytest.approx(np.hypot(0.5, 1.0), abs=1e-7)
    below = [Contact([x, 0.0, 0.0], [0.0, 0.0, 1.0], "frictionless") for x in (1.0, -2.0)]
    found = contact_forces(below, DOWN)
    assert found.components == pytest.approx([2.0 / 3.0, 1.0 / 3.0], abs=1e-9)


def least_total(contacts, load, edges, wider):
    """Total normal force of pyramids inside the cones, or around them, by a linear program."""
    rays = []
    for one in contacts:
        mu = one.friction * (1.0 / np.cos(np.pi / edges) if wider else 1.0)
        for a in 2.0 * np.pi * np.arange(edges) / edges:
            f = one.normal + mu * (np.cos(a) * one.tangents[0] + np.sin(a) * one.tangents[1])
            rays.append([*np.cross(one.position, f), *f])
    A = np.array(rays).T
    return linprog(np.ones(A.shape[1]), A_eq=A, b_eq=-load, method="highs").fun


def test_the_total_is_between_those_of_pyramids():
    rng = np.random.default_rng(10)
    contacts, load = random_sphere(rng, 4, 0.9), rng.normal(size=6)
    total = contact_forces(contacts, load, smallest="total").total
    around, inside = (least_total(contacts, load, 200, wider) for wider in (True, False))
    assert around - 1e-7 <= total <= inside + 1e-7
    assert inside - around < 1e-2 * total


def test_an_impossible_load_is_answered_with_its_direction():
    rng = np.random.default_rng(11)
    for contacts in (
        on_sphere([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]], 0.3),
        opposed("point", 0.4),
    ):
        refused = 0
        for _ in range(10):
            load = rng.normal(size=6)
            found = contact_forces(contacts, load)
            if found.status is not ForceStatus.NOT_HELD:
                continue
            refused += 1
            s = found.separating_wrench
            assert s @ load < -1e-6
            assert np.isnan(found.forces).all()
            for one in contacts:
                along = np.cross(s[:3], one.position) + s[3:]
                normal = along @ one.normal
                across = np.linalg.norm(along - normal * one.normal)
                assert normal + one.friction * across < 1e-6
        assert refused >= 5


def test_a_pair_cannot_turn_about_its_axis():
    found = contact_forces(opposed("point", 0.5), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert found.status is ForceStatus.NOT_HELD
    assert np.abs(found.separating_wrench) == pytest.approx([1.0, 0, 0, 0, 0, 0], abs=1e-6)
    soft = contact_forces(opposed("soft", 0.5, 0.1), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert soft.status is ForceStatus.HELD
    assert np.abs(soft.torsions) == pytest.approx([0.5, 0.5], abs=1e-6)


def test_no_load_needs_no_force():
    found = contact_forces(opposed("point", 0.5), np.zeros(6))
    assert found.status is ForceStatus.HELD
    assert not found.forces.any()


def test_forces_in_the_plane():
    pair = [Contact([x, 0.0], [-x, 0.0], "point", 0.5) for x in (1.0, -1.0)]
    found = contact_forces(pair, [0.2, 0.0, -1.0])
    assert found.forces.shape == (2, 2)
    assert grasp_matrix(pair, [0.0, 0.0]) @ found.components == pytest.approx(
        [-0.2, 0, 1.0], abs=1e-9
    )


def test_without_the_solver_the_error_names_the_command(monkeypatch):
    monkeypatch.setitem(sys.modules, "clarabel", None)
    with pytest.raises(ConicSolverUnavailableError, match=r"pip install 'robomech_ros\[hands\]'"):
        contact_forces(opposed("point", 0.5), DOWN)
