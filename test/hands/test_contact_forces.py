"""The smallest contact forces, and the direction in which a load cannot be held."""

import sys

import numpy as np
import pytest
from grasps import CUBE, TETRAHEDRON, on_sphere, opposed, random_sphere
from scipy.optimize import linprog

from robomech_ros.hands import (
    ConicSolverUnavailableError,
    Contact,
    ForceStatus,
    contact_forces,
    grasp_matrix,
)

DOWN = [0.0, 0.0, 0.0, 0.0, 0.0, -1.0]


def reaches(one):
    """How far friction along both tangents and torsion go for a unit of normal force."""
    friction = 0.0 if one.model == "frictionless" else one.friction
    return np.array([friction, friction, one.torsional if one.model == "soft" else 0.0])


def excess(contacts, found):
    """How far forces are outside their cones."""
    worst = -np.inf
    for one, force, torsion in zip(contacts, found.forces, found.torsions, strict=True):
        normal = force @ one.normal
        across = np.linalg.norm(force - normal * one.normal)
        share = 0.0
        for size, reach in zip((across, abs(torsion)), reaches(one)[1:], strict=True):
            if reach:
                share = np.hypot(share, size / reach)
            else:
                worst = max(worst, size)
        worst = max(worst, share - normal)
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


def test_moments_about_the_line_through_two_contacts_are_held_by_no_forces():
    """The solver finds neither forces nor a proof of that, as no force however large helps."""
    rng = np.random.default_rng(14)
    for _ in range(20):
        contacts = random_sphere(rng, 2, 0.6, "point", 0.0)
        load = rng.normal(size=6)
        found = contact_forces(contacts, load)
        assert found.status is ForceStatus.NOT_HELD
        s = found.separating_wrench
        assert s @ load < -1e-6
        assert np.abs(s @ grasp_matrix(contacts, [0.0, 0.0, 0.0])).max() < 1e-9
        along = contacts[1].position - contacts[0].position
        np.testing.assert_allclose(np.cross(s[:3] + 0.0, along), np.zeros(3), atol=1e-9)


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


def every_kind(rng):
    """Contacts of all models, some without friction or torsion, that surround a sphere."""
    points = np.vstack([CUBE, TETRAHEDRON]) + 0.1 * rng.normal(size=(10, 3))
    kinds = [
        ("frictionless", 0.0, 0.0), ("point", 0.6, 0.0), ("point", 0.0, 0.0),
        ("soft", 0.4, 0.1), ("soft", 0.5, 0.0), ("soft", 0.0, 0.1),
    ]  # fmt: skip
    return [
        Contact(p, -p, model, friction * rng.uniform(0.8, 1.2), torsional * rng.uniform(0.8, 1.2))
        for p, (model, friction, torsional) in zip(points, [*kinds, *kinds[:4]], strict=True)
    ]


def least_largest(contacts, load, directions):
    """No more than the least greatest force: planes around cones and balls, a linear program."""
    count = 4 * len(contacts) + 1
    equal, above = np.zeros((6, count)), []
    bounds = [(None, None)] * count
    for k, one in zip(range(0, count - 1, 4), contacts, strict=True):
        axes, reach = np.vstack([one.normal, one.tangents]), reaches(one)
        equal[:, k : k + 3] = np.hstack([np.cross(one.position, axes), axes]).T
        equal[:3, k + 3] = one.normal
        bounds[k + 1 : k + 4] = [(None, None) if far else (0.0, 0.0) for far in reach]
        for u in directions:
            ball, cone = np.zeros((2, count))
            ball[k : k + 3], ball[-1] = u, -1.0
            cone[k + 1 : k + 4] = np.divide(u, reach, out=np.zeros(3), where=reach > 0.0)
            cone[k] = -np.linalg.norm(u[reach > 0.0])
            above += [ball, cone]
    cost = np.eye(count)[-1]
    return linprog(cost, above, np.zeros(len(above)), equal, -load, bounds, method="highs").fun


def test_the_greatest_force_of_contacts_of_every_kind_is_the_least():
    """Grasps of the same kinds with other numbers, one after the other, each its own optimum."""
    rng = np.random.default_rng(15)
    directions = rng.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    for _ in range(3):
        contacts, load = every_kind(rng), rng.normal(size=6)
        least = least_largest(contacts, load, directions)
        found = contact_forces(contacts, load)
        balance = grasp_matrix(contacts, [0.0, 0.0, 0.0]) @ found.components + load
        assert np.abs(balance).max() < 1e-9 * np.linalg.norm(load)
        assert excess(contacts, found) < 1e-7
        assert least - 1e-7 <= found.largest <= 1.05 * least
        again = contact_forces(contacts, load, smallest="total")
        assert again.total <= found.total + 1e-7
        assert found.largest <= again.largest + 1e-7


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


def towards_the_border(rng, count, model):
    """A grasp that is not closed, a load that it holds, and one that it does not."""
    while True:
        contacts = random_sphere(rng, count, rng.uniform(0.1, 0.4), model, 0.1)
        pressed = [np.r_[one.normal, np.zeros(max(one.size - 3, 0))] for one in contacts]
        if model == "frictionless":
            pressed = [np.ones(1)] * count
        held = -grasp_matrix(contacts, np.zeros(3)) @ np.concatenate(pressed)
        beyond = held + 8.0 * rng.normal(size=6)
        if contact_forces(contacts, beyond).status is ForceStatus.NOT_HELD:
            return contacts, held, beyond


@pytest.mark.parametrize(
    ("count", "model"), [(3, "point"), (3, "soft"), (4, "point"), (6, "soft"), (8, "frictionless")]
)
def test_forces_are_inside_their_cones_up_to_the_border(count, model):
    """Close to it the solver ends without an answer, and with forces far outside the cones."""
    rng = np.random.default_rng(3)
    for _ in range(3):
        contacts, held, beyond = towards_the_border(rng, count, model)
        low, high = 0.0, 1.0
        while high - low > 1e-11:
            middle = 0.5 * (low + high)
            load = held + middle * (beyond - held)
            found = contact_forces(contacts, load)
            if found.status is ForceStatus.HELD:
                assert excess(contacts, found) < 1e-8 * np.linalg.norm(load)
                low = middle
            else:
                if found.separating_wrench is None:
                    # Nothing can be said only where the load is hardly beyond.
                    assert high - low < 1e-6
                else:
                    s = found.separating_wrench
                    assert along(contacts, s) <= 1e-6 * -(s @ load)
                high = middle


def along(contacts, direction):
    """How far a wrench of a unit normal force goes along a direction of wrenches."""
    farthest = -np.inf
    for one in contacts:
        force = direction[3:] + np.cross(direction[:3], one.position)
        mu, _, torsional = reaches(one)
        across = mu * np.linalg.norm(force - (force @ one.normal) * one.normal)
        turned = torsional * (direction[:3] @ one.normal)
        farthest = max(farthest, force @ one.normal + np.hypot(across, turned))
    return farthest


@pytest.mark.parametrize(
    ("part", "held"), [(-1e-7, True), (0.0, True), (1e-7, False), (1e-4, False)]
)
def test_a_load_on_the_border_of_one_cone(part, held):
    """Without internal forces the answer needs no solver: here it ended 7e-5 outside the cone."""
    rng = np.random.default_rng(0)
    for _ in range(20):
        (one,) = random_sphere(rng, 1, rng.uniform(0.2, 1.0))
        force = one.normal + one.friction * (1.0 + part) * one.tangents[0]
        load = -grasp_matrix([one], np.zeros(3)) @ force
        found = contact_forces([one], load)
        assert (found.status is ForceStatus.HELD) == held
        if held:
            np.testing.assert_allclose(found.forces[0], force, atol=1e-9)
        else:
            assert along([one], found.separating_wrench) < 1e-14
            assert found.separating_wrench @ load < 0.0


@pytest.mark.parametrize("shift", [0.0, 1e-14, 1e-12])
def test_contacts_that_are_in_a_plane_but_for_rounding(shift):
    """Contacts with normals in a plane keep holding a load when their positions are rounded."""
    rng = np.random.default_rng(2)
    a = np.arange(6.0)
    rim = np.stack([np.cos(a), np.sin(a), shift * rng.normal(size=6)], axis=1)
    inward = np.stack([-np.cos(a + 0.1 * a % 0.3), -np.sin(a + 0.1 * a % 0.3), 0.0 * a], axis=1)
    contacts = [Contact(p, n, "frictionless") for p, n in zip(rim, inward, strict=True)]
    for _ in range(10):
        normal = rng.uniform(0.0, 1.0, size=6)
        load = -grasp_matrix(contacts, np.zeros(3)) @ normal
        assert contact_forces(contacts, load).status is ForceStatus.HELD


def test_the_origin_of_moments_does_not_matter():
    rng = np.random.default_rng(4)
    for _ in range(10):
        contacts, load = random_sphere(rng, 4, 0.5), rng.normal(size=6)
        near = contact_forces(contacts, load)
        far = np.array([1e4, -2e4, 3e3])
        moved = np.r_[load[:3] - np.cross(far, load[3:]), load[3:]]
        found = contact_forces(contacts, moved, origin=far)
        assert found.status is near.status
        if near.separating_wrench is None:
            np.testing.assert_allclose(found.forces, near.forces, atol=1e-6)
        else:
            assert found.separating_wrench @ moved < 0.0
