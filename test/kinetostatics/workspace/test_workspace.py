"""The boundary of the workspace against sampled postures, closed forms and bad input."""

import functools
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, MissingLimitsError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.kinetostatics import reach_limits, workspace_boundary
from robomech_ros.kinetostatics.workspace.boundary import positioning_boundary
from robomech_ros.kinetostatics.workspace.positioning_part import positioning_part
from robomech_ros.robots import chain_from_dh, load_robot
from robomech_ros.robots.chain_layout import PRISMATIC, pack_chain, unpack_chain

H = math.pi / 2


def positioning(a, b, alpha, beyond, limits=None):
    """Three joints that carry a point ``beyond`` the last of them along its z axis."""
    tool = np.eye(4)
    tool[2, 3] = beyond
    return chain_from_dh(a, b, alpha, tool=tool, limits=limits)


def ranges(lower, upper):
    return {"lower": np.array(lower), "upper": np.array(upper)}


NARROW = ranges([-2.5, -0.4, -2.6], [2.2, 2.1, 0.9])


def arm(name, limited):
    """Return an arm, those that are made here with or without limits."""
    limits = NARROW if limited else None
    made = {
        "elbow": lambda: chain_from_dh([0, 0.5, 0.3], [0, 0, 0], [H, 0, 0]),
        "arcmate": lambda: positioning([0.2, 0.6, 0.13], [0.81, 0, 0.03], [H, 0, H], 0.55, limits),
        "orthogonal": lambda: chain_from_dh(
            [0.12, 0.24, 0.18], [0, 0.12, 0], [-H, H, 0], limits=limits
        ),
    }
    return made[name]() if name in made else load_robot(name)


ARMS = [
    (name, limited)
    for name in ("puma560", "arcmate", "stanford", "irb120", "orthogonal", "scara")
    for limited in (True, False)
    if limited or name in ("puma560", "orthogonal")
]


@functools.cache
def space_of(name, limited):
    return workspace_boundary(arm(name, limited), respect_limits=limited)


@pytest.fixture(scope="module", params=ARMS, ids=lambda p: f"{p[0]}-{'limits' if p[1] else 'free'}")
def space(request):
    return space_of(*request.param)


def sampled(section, rng, count):
    """Postures, evenly over the ranges, and of one in ten with a joint at the end of its range."""
    ranges = section.upper[1:] - section.lower[1:]
    share = (rng.uniform(size=2) + np.arange(count)[:, None] * low_discrepancy_strides(2)) % 1.0
    q = section.lower[1:] + ranges * share
    edge = rng.integers(0, 40, count)
    for joint in (0, 1):
        for case, bound in ((0, section.lower), (1, section.upper)):
            rows = edge == 2 * joint + case
            q[rows, joint] = bound[1 + joint]
    return q


def bounding(space):
    return [curve for curve in space.curves if curve.role != "interior"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "widest"), [(150_000, 3e-3), pytest.param(1_000_000, 1e-3, marks=pytest.mark.long)]
)
def test_many_postures_are_inside_and_come_near_all_of_the_boundary(space, count, widest):
    from scipy.spatial import cKDTree

    size = space.section.size
    q = sampled(space.section, np.random.default_rng(7), count)
    points = space.section.image(q[:, 0], q[:, 1])
    vertices, normals = space.nearest.points, space.nearest.normals
    rough, index = cKDTree(vertices).query(points, distance_upper_bound=5e-3 * size, workers=2)
    near = np.flatnonzero(np.isfinite(rough))
    inward = ((points[near] - vertices[index[near]]) * normals[index[near]]).sum(axis=1)
    # Whatever may be outside as far as the polygon tells, against the curve itself.
    doubtful = points[near[inward < 3e-6 * size]]
    distance, feet, vertex, _ = space.nearest.find(doubtful)
    offset = ((doubtful - feet) * normals[vertex]).sum(axis=1)
    # At corners, which have two sides, the count decides.
    beyond = offset < -1e-9
    assert space.section_count(doubtful[beyond]).all()
    beyond &= np.abs(offset) > 0.1 * distance
    ends = cKDTree(vertices[space.nearest.is_end])
    assert ends.query(doubtful[beyond])[0].max(initial=0.0) < 5e-3 * size
    gap, _ = cKDTree(points[near]).query(vertices)
    assert gap.max() < widest * max(1.0, size)


def test_vertices_are_postures_on_the_boundary(space):
    for curve in space.curves:
        again = space.section.image(curve.q[:, 0], curve.q[:, 1])
        assert np.abs(again - curve.points).max() < 1e-12
        if curve.cause == "singular":
            determinant = space.section.determinant(curve.q[:, 0], curve.q[:, 1])
            assert np.abs(determinant).max() < 1e-9 * space.section.size**3
        middle = len(curve.points) // 2
        tangent = curve.points[middle] - curve.points[middle - 1]
        normal = np.array((-tangent[1], tangent[0])) / np.linalg.norm(tangent)
        step = min(1e-4 * space.section.size, 0.1 * np.ptp(curve.points, axis=0).max())
        at = 0.5 * (curve.points[middle] + curve.points[middle - 1])
        counts = space.section_count([at + step * normal, at - step * normal])
        assert counts.tolist() == [curve.more, curve.fewer]


def test_distances_have_the_sign_of_being_inside(space):
    rng = np.random.default_rng(3)
    size = space.section.size
    points = rng.uniform(-1.2, 1.2, (60, 3)) * size
    distance = space.distance(points)
    assert ((distance > 0.0) == space.contains(points)).all()
    # Within a ball of this radius nothing changes.
    away = rng.normal(size=(60, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    ball = points + 0.95 * (np.abs(distance) - 0.005 * size).clip(0.0)[:, None] * away
    assert (space.contains(ball) == space.contains(points)).all()


def test_sampled_postures_of_all_three_joints_are_contained(space):
    section = space.section
    rng = np.random.default_rng(5)
    q = section.lower + (section.upper - section.lower) * rng.uniform(0, 1, (3000, 3))
    (p,) = section.derivatives(q[:, 1], q[:, 2], 0)
    c, s = np.cos(q[:, 0]), np.sin(q[:, 0])
    points = section.in_base(np.stack((c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]), axis=1))
    assert space.contains(points).all()
    reach = np.linalg.norm(p, axis=0)
    assert reach.max() <= space.greatest_reach + 1e-5
    assert reach.min() >= space.least_reach - 1e-5


def test_elbow_arm_in_closed_form():
    """Two links of 0.5 m and 0.3 m on a turning base: spheres of 0.8 m and 0.2 m."""
    space = space_of("elbow", False)
    assert {curve.role for curve in space.curves} == {"outer", "inner"}
    for curve in space.curves:
        radius = 0.8 if curve.role == "outer" else 0.2
        assert np.abs(np.linalg.norm(curve.points, axis=1) - radius).max() < 1e-9
        assert (curve.more, curve.fewer) == (4, 0)
    assert space.least_reach == pytest.approx(0.2, abs=1e-9)
    assert space.greatest_reach == pytest.approx(0.8, abs=1e-9)
    points = np.array([[0.5, 0, 0], [0.0, 0.75, 0], [0.1, 0, 0], [0, 0.6, 0.8]])
    assert space.distance(points) == pytest.approx([0.3, 0.05, -0.1, -0.2], abs=1e-6)
    assert space.solution_count(points).tolist() == [4, 4, 0, 0]


def test_slides_make_a_box_with_corners():
    limits = {"lower": np.zeros(3), "upper": np.array([1.0, 2.0, 3.0])}
    chain = chain_from_dh(
        [0, 0, 0], [0, 0, 0], [H, H, 0], theta=[0, H, 0], types="PPP", limits=limits
    )
    space = workspace_boundary(chain)
    inside = forward_kinematics(chain, [0.5, 1.0, 1.2])[:3, 3]
    assert space.coordinates == ("x", "y")
    assert space.solution_count(inside) == 1
    assert space.distance(inside) == pytest.approx(0.5, abs=1e-6)
    assert len(space.cusps) == 0
    assert {curve.role for curve in space.curves} == {"outer"}


def test_outside_the_distance_is_that_from_edges_and_corners_too():
    # A box of slides, and a wedge of a cylinder: joint 1 has limits.
    points = np.random.default_rng(4).uniform(-1.0, 2.0, (300, 3))
    box = chain_from_dh(
        [0.0] * 3, [0.0] * 3, [H, H, 0.0], [0.0, H, 0.0], types="PPP",
        limits=ranges([0.0] * 3, [1.0] * 3),
    )  # fmt: skip
    corner, opposite = forward_kinematics(box, [[0.0] * 3, [1.0] * 3])[:, :3, 3]
    lower, upper = np.minimum(corner, opposite), np.maximum(corner, opposite)
    away = np.linalg.norm(points - points.clip(lower, upper), axis=1)
    found = workspace_boundary(box).distance(points)
    assert found[away > 0.0] == pytest.approx(-away[away > 0.0], abs=1e-6)
    wedge = chain_from_dh(
        [0.0] * 3, [0.0] * 3, [0.0, H, 0.0], types="RPP",
        limits=ranges([-1.0, 0.0, 0.2], [1.0, 0.5, 0.8]),
    )  # fmt: skip
    q = np.random.default_rng(5).uniform([-1.0, 0.0, 0.2], [1.0, 0.5, 0.8], (20_000, 3))
    check_outside(wedge, q, points)


@pytest.mark.parametrize("name", ["puma560", "scara"])
def test_outside_no_posture_is_nearer_than_the_boundary_and_one_as_near(name):
    chain = load_robot(name)
    q = np.random.default_rng(5).uniform(chain.lower, chain.upper, (20_000, chain.n))
    check_outside(chain, q, np.random.default_rng(6).uniform(-1.0, 1.0, (120, 3)))


def check_outside(chain, q, points):
    """Compare distances of points that cannot be reached with those from postures (k, n)."""
    from scipy.spatial import cKDTree

    space, centre = workspace_boundary(chain), positioning_part(chain).in_tip
    T = forward_kinematics(chain, q)
    nearest, _ = cKDTree(T[:, :3, :3] @ centre + T[:, :3, 3]).query(points)
    found = -space.distance(points)
    outside = found > 0.0
    size = space.section.size
    assert outside.sum() > 50
    assert (found <= nearest + 1e-6 * size)[outside].all()
    assert (found >= nearest - 0.15 * size)[outside].all()


def test_orthogonal_arm_with_offsets_has_four_cusps_and_a_region_of_four():
    """Cusps are where three postures meet: there the count changes by two along any way round."""
    space = space_of("orthogonal", False)
    assert len(space.cusps) == 4
    assert sorted(np.round(np.abs(space.cusps[:, 1]), 4)) == [0.0606, 0.0606, 0.2398, 0.2398]
    assert space.section_count([0.3, 0.0]) == 4
    assert space.section_count([[0.48, 0.0], [0.6, 0.0]]).tolist() == [2, 0]
    section = space.section
    for cusp in space.cusps:
        # The image stands still there: the curve's velocity vanishes.
        rows = [c for c in space.curves if np.abs(c.points - cusp).max(axis=1).min() < 1e-12]
        assert len(rows) == 2
        k = int(np.abs(rows[0].points - cusp).max(axis=1).argmin())
        q = rows[0].q[k]
        f, fu, fv = section.determinant_gradient(*q)
        along = np.array((-fv, fu)) / np.hypot(fu, fv)
        moved = section.regular(q[0], q[1])
        velocity = (
            moved[0] * along[0] + moved[1] * along[1],
            moved[5] * along[0] + moved[6] * along[1],
        )
        assert abs(f) < 1e-13
        assert np.abs(velocity).max() < 1e-12


def test_nodes_are_reached_in_two_postures_to_rounding():
    space = space_of("puma560", True)
    assert len(space.nodes) == 2
    for node in space.nodes:
        ends = [
            c for c in space.curves for k in (0, -1) if np.abs(c.points[k] - node).max() < 1e-12
        ]
        assert len(ends) >= 3


def test_the_count_changes_at_curves_only(space):
    """Along straight lines the count changes where curves are crossed, and by what they tell."""
    rng = np.random.default_rng(11)
    section = space.section
    size = section.size
    for _ in range(4):
        start, end = rng.uniform((0.02, -1.0), (1.0, 1.0), (2, 2)) * size
        share = np.linspace(0.0, 1.0, 2000)[:, None]
        line = start + share * (end - start)
        counts = space.section_count(line)
        changes = np.flatnonzero(np.diff(counts))
        outline = np.concatenate([curve.points for curve in space.curves])
        for k in changes:
            gap = np.linalg.norm(outline - 0.5 * (line[k] + line[k + 1]), axis=1).min()
            assert gap < 4e-3 * size


def test_the_result_can_be_written():
    space = space_of("puma560", True)
    text = json.dumps(space.to_dict())
    again = json.loads(text)
    assert again["least_reach"] == space.least_reach
    assert len(again["curves"]) == len(space.curves)


PLANAR = {
    "RR": chain_from_dh([0.5, 0.3], [0, 0.1], [0, 0], limits=ranges([-2, 0.3], [1.5, 2.4])),
    "RP": chain_from_dh(
        [0.1, 0], [0, 0], [H, 0], types="RP", limits=ranges([-2, 0.2], [1, 0.7])
    ),
    "PR": chain_from_dh(
        [0.1, 0.3], [0, 0], [H, 0], types="PR", limits=ranges([-0.2, -1], [0.4, 2])
    ),
    "RRR": load_robot("planar3r"),
}  # fmt: skip


@pytest.mark.parametrize("kind", PLANAR)
def test_a_planar_arm_against_all_of_its_postures(kind):
    """Distances outside are those to the nearest of many postures of two joints."""
    from scipy.spatial import cKDTree

    chain = PLANAR[kind]
    space, part = positioning_boundary(chain), positioning_part(chain)
    size, section = space.section.size, space.section
    axes = [
        np.linspace(a, b, 500) for a, b in zip(section.lower[1:], section.upper[1:], strict=True)
    ]
    q = np.zeros((500 * 500, chain.n))
    q[:, :2] = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    q[:, 2:] = 0.7  # what it is does not matter
    T = forward_kinematics(chain, q)
    reached = T[:, :3, :3] @ part.in_tip + T[:, :3, 3]
    assert space.contains(reached[::311]).all()
    points = section.on_section(np.random.default_rng(1).uniform(-1, 1, (300, 2)) * size)
    distance = space.distance(points)
    assert ((distance > 0.0) == space.contains(points)).all()
    nearest, _ = cKDTree(reached).query(points)
    beyond = np.where(distance < 0.0, -distance, 0.0)
    assert np.abs(nearest - beyond).max() < 0.005 * size
    # Beside the plane nothing is reached.
    aside = points + 0.1 * size * section.base[:3, 2]
    assert not space.contains(aside).any()
    assert space.distance(aside) == pytest.approx(-np.hypot(0.1 * size, beyond), abs=1e-9)


TIPS = {
    "RRR": chain_from_dh(
        [0.5, 0.35, 0.2], [0] * 3, [0] * 3, limits=ranges([-2.0, -1.0, -2.2], [1.5, 2.4, 0.9])
    ),
    "PRR": chain_from_dh(
        [0.1, 0.3, 0.25], [0] * 3, [H, 0, 0], types="PRR", limits=ranges([0.1, -1, -2], [0.6, 2, 1])
    ),
    "RPR": chain_from_dh(
        [0.1, 0, 0.3], [0] * 3, [H, -H, 0], types="RPR", limits=ranges([-2, 0.1, -1], [1, 0.6, 2])
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("kind", TIPS)
def test_issue_12_the_tip_of_a_planar_arm_of_three_joints_against_all_of_its_postures(kind):
    from scipy.spatial import cKDTree

    chain = TIPS[kind]
    space = workspace_boundary(chain)
    extremes = pytest.approx(reach_limits(chain), abs=1e-6)
    assert (space.least_reach, space.greatest_reach) == extremes
    axes = [np.linspace(a, b, 60) for a, b in zip(chain.lower, chain.upper, strict=True)]
    q = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    reached = forward_kinematics(chain, q)[:, :3, 3]
    assert (space.solution_count(reached[::311]) == 1).all()
    assert space.distance(reached[::311]).min() > -1e-6
    size, section = space.section.size, space.section
    points = section.on_section(np.random.default_rng(1).uniform(-1, 1, (300, 2)) * size)
    distance = space.distance(points)
    assert ((distance > 0.0) == space.contains(points)).all()
    nearest, _ = cKDTree(reached).query(points)
    beyond = np.where(distance < 0.0, -distance, 0.0)
    assert np.abs(nearest - beyond).max() < 0.02 * size
    assert not space.contains(points + 0.1 * size * section.base[:3, 2]).any()
    for curve in space.curves:
        tips = forward_kinematics(chain, curve.q)[:, :3, 3]
        np.testing.assert_allclose(tips, space.swept(0.0, curve=curve), atol=1e-9)
        within = (curve.q >= chain.lower - 1e-9) & (curve.q <= chain.upper + 1e-9)
        assert within.all() and (curve.more, curve.fewer) == (1, 0)


@pytest.mark.slow
def test_issue_12_the_tip_of_the_planar_arm_reaches_as_far_as_its_links():
    """``greatest_reach`` was 1.8 m, of the axis of the third joint."""
    space = workspace_boundary(load_robot("planar3r"))
    assert space.least_reach == 0.0
    assert space.greatest_reach == pytest.approx(2.3, abs=1e-9)
    points = [[2.29, 0.0, 0.0], [2.31, 0.0, 0.0], [0.0, 0.0, 0.0], [-2.295, 0.0, 0.0]]
    assert space.contains(points).tolist() == [True, False, True, False]
    assert space.distance(points)[:2] == pytest.approx([0.01, -0.01], abs=1e-6)
    free = workspace_boundary(load_robot("planar3r"), respect_limits=False)
    assert [curve.role for curve in free.curves] == ["outer"]
    ring = workspace_boundary(chain_from_dh([1.0, 0.3, 0.2], [0] * 3, [0] * 3))
    assert {(curve.role, curve.cause) for curve in ring.curves} == {
        ("outer", "singular"),
        ("inner", "singular"),
    }
    assert (ring.least_reach, ring.greatest_reach) == pytest.approx((0.5, 1.5), abs=1e-9)


def test_a_planar_arm_in_closed_form():
    """Links of 0.5 m and 0.3 m, which turn freely: circles of 0.8 m and 0.2 m."""
    space = workspace_boundary(chain_from_dh([0.5, 0.3], [0, 0], [0, 0]))
    assert space.coordinates == ("x", "y")
    assert {(curve.role, curve.cause) for curve in space.curves} == {
        ("outer", "singular"),
        ("inner", "singular"),
    }
    assert (space.least_reach, space.greatest_reach) == pytest.approx((0.2, 0.8), abs=1e-9)
    points = [[0.3, 0.4, 0.0], [0.0, 0.1, 0.0], [0.0, 1.1, 0.4]]
    assert space.solution_count(points).tolist() == [2, 0, 0]
    assert space.distance(points) == pytest.approx([0.3, -0.1, -0.5], abs=1e-6)


def scaled(chain, factor):
    """Return an arm with all its lengths multiplied."""
    C, slides = unpack_chain(chain.packed).copy(), chain.types == PRISMATIC
    C[:, :3, 3] *= factor
    lower, upper = (np.where(slides, factor, 1.0) * ends for ends in (chain.lower, chain.upper))
    return replace(chain, packed=pack_chain(C, chain.types), lower=lower, upper=upper)


@pytest.mark.parametrize("factor", [1e-6, 1e4])
def test_the_size_of_an_arm_does_not_matter(factor):
    chain = arm("stanford", True)
    usual, other = space_of("stanford", True), workspace_boundary(scaled(chain, factor))
    assert len(usual.curves) == len(other.curves)
    assert len(usual.nodes) == len(other.nodes) > 0
    assert other.greatest_reach == pytest.approx(factor * usual.greatest_reach)
    points = np.array([[0.3, 0.2, 0.1], [0.0, 0.0, 3.0], [0.1, -0.4, 0.3]])
    assert other.distance(factor * points) == pytest.approx(
        factor * usual.distance(points), rel=1e-6
    )


@pytest.mark.parametrize("name", ["ur5e", "panda", "diestro"])
def test_arms_without_a_positioning_part_are_refused(name):
    with pytest.raises(BadValueError, match="joints that place a point"):
        workspace_boundary(load_robot(name))


def test_two_joints_that_leave_the_plane_are_refused():
    with pytest.raises(BadValueError, match="'joint_2' moves links out of the plane"):
        workspace_boundary(chain_from_dh([0, 0.3], [0, 0], [H, 0]))


@pytest.mark.parametrize("locked", [0, 1, 2])
@pytest.mark.parametrize("types", ["RRR", "RPP"])
def test_an_arm_with_a_locked_joint_moves_on_a_surface_only(locked, types):
    lower, upper = np.array([-1.0, 0.1, 0.1]), np.array([1.0, 0.5, 0.6])
    upper[locked] = lower[locked]
    arm = chain_from_dh([0.1, 0.4, 0.3], [0.0] * 3, [H, H, 0.0], types=types,
                        limits=ranges(lower, upper))  # fmt: skip
    with pytest.raises(BadValueError, match="not on a surface only"):
        workspace_boundary(arm)


def test_bad_input_is_refused():
    with pytest.raises(BadValueError, match="SerialChain"):
        workspace_boundary("puma560")
    endless = chain_from_dh([0, 0, 0], [0, 0.2, 0], [H, H, 0], types="RRP")
    with pytest.raises(MissingLimitsError, match="joint_3"):
        workspace_boundary(endless)
    space = space_of("elbow", False)
    with pytest.raises(WrongSizeError, match="points"):
        space.distance([1.0, 2.0])
    with pytest.raises(NonFiniteError, match="points"):
        space.contains([1.0, math.nan, 0.0])


def test_points_farther_away_than_squares_can_tell_have_a_finite_distance():
    """A pose at 1e200 m was an IndexError, and 900 for who asked by service."""
    boundary = workspace_boundary(load_robot("puma560"))
    assert boundary.distance([[1e200, 0.0, 0.0], [0.0, 0.0, -1e308]]).tolist() == [-1e100, -1e100]
