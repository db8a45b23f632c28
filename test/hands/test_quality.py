"""Bounds of the quality of Ferrari and Canny: known figures, invariance, and what holds of any."""

import numpy as np
import pytest
from grasps import CUBE, EQUATOR, TETRAHEDRON, disc, on_sphere, opposed, random_sphere
from scipy.spatial.transform import Rotation

from robomech_ros.hands import Contact, grasp_quality

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
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_qualities(name):
    contacts, lower, upper = KNOWN[name]
    found = grasp_quality(contacts, length=1.0)
    assert found.certified
    assert found.upper - found.lower <= 1e-4
    assert found.lower <= upper + 1e-9
    assert found.upper >= lower - 1e-9


def test_bounds_hold_where_they_are_not_close_yet():
    found = grasp_quality(on_sphere(EQUATOR, 1.0), length=1.0, most_points=80)
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
