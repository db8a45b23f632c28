"""Bounds of the quality of Ferrari and Canny: known figures, invariance, and what holds of any."""

import numpy as np
import pytest
from grasps import CUBE, EQUATOR, TETRAHEDRON, disc, on_sphere, opposed, random_sphere
from scipy.optimize import minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from robomech_ros.hands import Contact, grasp_matrix, grasp_quality, is_force_closed
from robomech_ros.hands.contacts import cones_of, rows_of

# Grasps, and between what figures the quality is (ROS_FACTS_2, section 4).
KNOWN = {
    "disc of 2, 0.5": (disc(2, 0.5), 1.0 / 3.0, 1.0 / 3.0),
    "disc of 2, 0.8": (disc(2, 0.8), 0.8 / np.sqrt(2.64), 0.8 / np.sqrt(2.64)),
    "disc of 3, 0.3": (disc(3, 0.3), 0.3, 0.3),
    "disc of 3, 0.5": (disc(3, 0.5), 0.5, 0.5),
    "disc of 3, 1.0": (disc(3, 1.0), 0.935113, 0.935114),
    "disc of 4, 0.7": (disc(4, 0.7), 0.7, 0.7),
    "disc of 4, 1.0": (disc(4, 1.0), 1.0, 1.0),
    "cube, 0.5": (on_sphere(CUBE, 0.5), 0.5 * np.sqrt(2 / 3), 0.5 * np.sqrt(2 / 3)),
    "tetrahedron, 0.5": (
        on_sphere(TETRAHEDRON, 0.5),
        0.5 / np.sqrt(2) - 2e-5,
        0.5 / np.sqrt(2) + 2e-5,
    ),
    "equator, 0.3": (on_sphere(EQUATOR, 0.3), 0.165250, 0.165287),
    "equator, 1.0": (on_sphere(EQUATOR, 1.0), 0.577326, 0.577391),
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_qualities(name):
    contacts, lower, upper = KNOWN[name]
    found = grasp_quality(contacts, length=1.0)
    assert found.certified
    assert 0.0 <= found.upper - found.lower <= 1e-4
    assert found.lower <= upper + 1e-9
    assert found.upper >= lower - 1e-9


def test_bounds_hold_where_they_are_not_close_yet():
    found = grasp_quality(on_sphere(EQUATOR, 1.0), length=1.0, max_wrenches=80)
    assert not found.certified
    assert found.lower <= 0.577326 <= 0.577391 <= found.upper


def resisted(contacts, u, length):
    """The largest wrench along u of unit normal forces, contact by contact."""
    heights = []
    for one in contacts:
        n, v = u[:3] / length, u[3:]
        force = np.cross(n, one.position) + v
        tangential = force - one.normal * (force @ one.normal)
        parts = [one.friction * np.linalg.norm(tangential), one.torsional * (n @ one.normal)]
        heights.append(force @ one.normal + np.linalg.norm(parts))
    return max(heights)


def test_no_direction_is_resisted_less_than_the_lower_bound():
    rng = np.random.default_rng(6)
    for k in (3, 4, 5):
        contacts = random_sphere(rng, k, 0.8, "soft", 0.2)
        found = grasp_quality(contacts, length=0.7, origin=np.zeros(3))
        assert np.isclose(resisted(contacts, found.weakest, 0.7), found.upper, atol=1e-9)
        directions = rng.normal(size=(300, 6))
        near = found.weakest + 0.1 * rng.normal(size=(300, 6))
        for u in [*directions, *near]:
            assert resisted(contacts, u / np.linalg.norm(u), 0.7) >= found.lower


def closed_grasps(kind, count, how_many):
    """Random closed grasps, those without friction in the plane, where a few contacts close one."""
    rng, found = np.random.default_rng(count), []
    while len(found) < how_many:
        if kind == "frictionless in the plane":
            p, turn = rng.uniform(0.0, 2.0 * np.pi, count), rng.uniform(-0.4, 0.4, count)
            grasp = [
                Contact([np.cos(a), np.sin(a)], [-np.cos(a + b), -np.sin(a + b)], "frictionless")
                for a, b in zip(p, turn, strict=True)
            ]
        else:
            grasp = random_sphere(rng, count, rng.uniform(0.3, 1.0), kind, rng.uniform(0.05, 0.3))
        if is_force_closed(grasp):
            found.append(grasp)
    return found


def least_resisted(contacts, rng, starts):
    """The least that a search from random directions finds: never below the quality."""
    size = 3 if contacts[0].planar else 6
    cones = cones_of(rows_of(contacts), np.mean([one.position for one in contacts], axis=0), 1.0)

    def most(u):
        along = cones @ (u / np.linalg.norm(u))
        return float((along[:, 0] + np.linalg.norm(along[:, 1:], axis=1)).max())

    options = {"maxiter": 4000, "maxfev": 4000, "xatol": 1e-9, "fatol": 1e-12}
    ends = [minimize(most, rng.normal(size=size), method="Nelder-Mead") for _ in range(starts)]
    best = min(ends, key=lambda end: end.fun)
    return minimize(most, best.x, method="Nelder-Mead", options=options).fun


@pytest.mark.parametrize("kind", ["frictionless in the plane", "point", "soft"])
@pytest.mark.parametrize("count", [4, 5, 6])
def test_random_grasps_are_certified_and_agree_with_a_search(kind, count):
    rng = np.random.default_rng(21)
    for grasp in closed_grasps(kind, count, 4):
        found = grasp_quality(grasp, length=1.0)
        assert found.certified
        assert 0.0 <= found.upper - found.lower <= 1e-4
        assert least_resisted(grasp, rng, 3) >= found.lower


def quality_of_rays(contacts, rays):
    """Distance of the nearest facet of the hull of finitely many wrenches."""
    o = np.mean([one.position for one in contacts], axis=0)
    wrenches = []
    for one, forces in zip(contacts, rays, strict=True):
        G = grasp_matrix([Contact(one.position, one.normal, "point")], o)
        wrenches.extend(G @ force for force in forces)
    return float(-ConvexHull(wrenches, qhull_options="QJ").equations[:, -1].max())


def test_without_friction_the_hull_of_the_normals_is_exact():
    rng = np.random.default_rng(22)
    held = 0
    for grasp in closed_grasps("frictionless in the plane", 5, 10):
        found = grasp_quality(grasp, length=1.0)
        exact = quality_of_rays(grasp, [[one.normal] for one in grasp])
        assert found.lower - 1e-7 <= exact <= found.upper + 1e-7
    for _ in range(200):
        p, n = rng.normal(size=(2, 12, 3))
        grasp = [Contact(a, b) for a, b in zip(p, n, strict=True)]
        if is_force_closed(grasp):
            held += 1
            found = grasp_quality(grasp, length=1.0)
            exact = quality_of_rays(grasp, [[one.normal] for one in grasp])
            assert found.lower - 1e-7 <= exact <= found.upper + 1e-7
            assert found.certified
    assert held >= 5


def test_quality_is_between_those_of_pyramids():
    turns = 2.0 * np.pi * np.arange(16) / 16
    rim = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    for grasp in closed_grasps("point", 4, 4):
        found = grasp_quality(grasp, length=1.0)
        inside, around = (
            quality_of_rays(grasp, [c.normal + size * c.friction * rim @ c.tangents for c in grasp])
            for size in (1.0, 1.0 / np.cos(np.pi / 16))
        )
        assert inside <= found.upper + 1e-7
        assert found.lower <= around + 1e-7
        assert around - inside < 0.05


def test_bounds_can_be_closer():
    for contacts, length in ((on_sphere(CUBE, 0.5), 0.3), (on_sphere(CUBE, 0.5), 1.0)):
        wide = grasp_quality(contacts, length=length)
        close = grasp_quality(contacts, length=length, tolerance=1e-7)
        assert close.certified
        assert 0.0 <= close.upper - close.lower <= 1e-7
        assert wide.lower <= close.upper
        assert close.lower <= wide.upper
    assert close.lower == pytest.approx(0.5 * np.sqrt(2 / 3), abs=1e-6)


# Contacts at which the hull of a library, with facets of many points in one plane, ended in an
# error.
FLAT = [
    [-0.7057964014836479, -0.15941140086765726, -0.6902459307566721],
    [0.18574832822700973, 0.05791922310987237, -0.9808888429150471],
    [-0.46325108874317744, 0.8466474684479314, -0.2618902307245726],
    [0.17470359488711218, -0.4016048175598078, -0.8989951192560911],
    [0.308588903686802, -0.5747682698752978, -0.7579012630058973],
    [-0.05144390965695579, -0.7415948585582101, -0.6688726260800597],
]


def test_contacts_that_make_flat_facets():
    found = grasp_quality(on_sphere(FLAT, 0.6156599617604868), length=1.0)
    assert found.certified
    assert 0.0 < found.lower <= found.upper <= found.lower + 1e-4


@pytest.mark.parametrize("length", [1e-9, 1e-6, 1e3, 1e6])
def test_extreme_lengths_have_bounds_that_hold(length):
    contacts = on_sphere(TETRAHEDRON, 0.5)
    found = grasp_quality(contacts, length=length)
    assert 0.0 <= found.lower <= found.upper
    assert np.isfinite(found.upper)
    assert resisted(contacts, found.weakest, length) == pytest.approx(found.upper, rel=1e-9)
    assert np.linalg.norm(found.weakest) == pytest.approx(1.0)


def test_twenty_soft_fingers_are_answered():
    contacts = random_sphere(np.random.default_rng(3), 20, 0.5, "soft", 0.2)
    found = grasp_quality(contacts, length=1.0)
    few = grasp_quality(contacts[:8], length=1.0, origin=found.origin)
    assert found.certified
    # More contacts never lower it.
    assert few.lower <= found.upper


def test_quality_does_not_depend_on_frame_and_order():
    rng = np.random.default_rng(7)
    contacts = random_sphere(rng, 4, 0.6)
    R, shift = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    moved = [Contact(R @ c.position + shift, R @ c.normal, "point", 0.6) for c in contacts]
    first = grasp_quality(contacts, length=1.0)
    for other in (moved, contacts[::-1]):
        found = grasp_quality(other, length=1.0)
        assert found.lower <= first.upper
        assert first.lower <= found.upper


def test_quality_states_its_length_and_origin():
    contacts = on_sphere(CUBE, 0.5)
    found = grasp_quality(contacts, length=2.0)
    assert found.length == 2.0
    assert found.origin.tolist() == [0.0, 0.0, 0.0]
    twice = [Contact(2.0 * c.position, c.normal, "point", 0.5) for c in contacts]
    same = grasp_quality(twice, length=2.0)
    assert same.lower == pytest.approx(0.5 * np.sqrt(2 / 3), abs=1e-4)
    assert found.upper < same.lower  # the cube of half the size resists less moment


def test_open_grasps_have_no_quality():
    found = grasp_quality(opposed("point", 0.5), length=1.0)
    assert (found.lower, found.upper, found.certified) == (0.0, 0.0, True)
    assert not found.weakest.any()


def test_the_same_grasp_gives_the_same_bytes():
    contacts = random_sphere(np.random.default_rng(8), 4, 0.6)
    first, second = (grasp_quality(contacts, length=1.0) for _ in range(2))
    assert (first.lower, first.upper) == (second.lower, second.upper)
    assert first.weakest.tobytes() == second.weakest.tobytes()
