"""The workspace as it is seen, against counts of postures by the solver of the whole arm."""

import math

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, MissingLimitsError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import reach_map, workspace_boundary
from robomech_ros.robots import chain_from_dh, load_robot
from robomech_ros.rvs.model.workspace.reach_points import (
    DENSITIES,
    MEASURES,
    ORIENTATIONS,
    computed_map,
    reach_points,
)
from robomech_ros.rvs.model.workspace.section_drawing import (
    draw_section,
    section_legend,
    section_points,
)
from robomech_ros.rvs.model.workspace.workspace_views import (
    is_in_opening,
    open_intervals,
    section_view,
    why_no_section,
)

WITH_BOUNDARY = ["irb120", "m1013", "planar3r", "puma560", "rv4fr", "scara", "stanford", "vx300"]


@pytest.fixture(scope="module")
def puma():
    """A PUMA 560 and its section."""
    chain = load_robot("puma560")
    return chain, section_view(chain)


def places(view, count, number, rng):
    """Places of the section in the middle of squares of a region."""
    found = np.argwhere(view.counts == count)
    chosen = found[rng.permutation(len(found))[:number]]
    return [
        np.array([0.5 * (edge[k] + edge[k + 1]) for edge, k in zip(view.edges, at, strict=True)])
        for at in chosen
    ]


def test_regions_have_as_many_postures_as_the_whole_arm_finds(puma):
    """The postures of joints 1 to 3 count, for any wrist; joint 1 has its limits, too."""
    chain, view = puma
    rng, T = np.random.default_rng(3), forward_kinematics(chain, chain.home())
    seen = 0
    for count in np.unique(view.counts).tolist():
        for place in places(view, count, 6, rng):
            target = view.target(place, T)
            np.testing.assert_allclose(view.coordinates(target), place, atol=1e-12)
            np.testing.assert_allclose(target[:3, :3], T[:3, :3])
            solutions = inverse_kinematics(chain, target, respect_limits=False).q
            first = [np.mod(q[:3] + np.pi, 2.0 * np.pi) - np.pi for q in solutions]
            # Joint 1 is free in the section; the others have a turn that is inside their limits.
            inside = {
                tuple(np.round(q, 6))
                for q in first
                if any(
                    np.all((chain.lower[1:3] <= p) & (p <= chain.upper[1:3]))
                    for p in q[1:]
                    + 2.0 * np.pi * np.array(np.meshgrid(*[(-1, 0, 1)] * 2)).T.reshape(-1, 2)
                )
            }
            assert len(inside) == count
            seen += 1
    assert seen >= 18


@pytest.mark.parametrize("robot", WITH_BOUNDARY)
def test_the_section_is_that_of_the_boundary(robot):
    chain = load_robot(robot)
    view, space = section_view(chain), workspace_boundary(chain)
    assert view.space.greatest_reach == space.greatest_reach
    middles = [0.5 * (edge[1:] + edge[:-1]) for edge in view.edges]
    x, y = np.meshgrid(*middles, indexing="ij")
    np.testing.assert_array_equal(view.counts, space.section_count(np.stack((x, y), axis=-1)))
    for curve in space.curves:
        for axis, values in zip(view.axes, curve.points.T, strict=True):
            assert axis.low <= values.min() + 1e-9 and values.max() <= axis.high
    # A metre is as long across as upwards.
    corners = np.array([[axis.low, axis.high] for axis in view.axes]).T
    (left, bottom), (right, top) = section_points(view, corners)
    width, height = np.diff(corners, axis=0)[0]
    assert (right - left) / width == pytest.approx((bottom - top) / height, rel=0.01)
    assert 0.25 < width / height <= 1.0
    picture = draw_section(view)
    for count in np.unique(view.counts[view.counts > 0]).tolist():
        assert f'data-count="{count}"' in picture
        assert f">{count} posture" in section_legend(view)
    # The arm is where its ring is: inside.
    T = forward_kinematics(chain, chain.home())
    points, _ = view.segments()
    assert np.isfinite(points).all() and view.plane(T).shape == (4, 4)


@pytest.mark.parametrize("robot", WITH_BOUNDARY)
def test_the_surface_is_the_boundary_with_a_sector_left_open(robot):
    view = section_view(load_robot(robot))
    cut, whole = view.surface(cut=True), view.surface(cut=False)
    if view.space.section.flat:
        assert cut is None and whole is None
        return
    for solid in (cut, whole):
        assert solid.faces.min() == 0 and solid.faces.max() < len(solid.vertices)
        local = view.space.section.in_frame(solid.vertices)
        found, *_ = view.space.nearest.find(view.space.section.coordinates(local))
        assert found.max() < 1e-6
    local = view.space.section.in_frame(cut.vertices)
    off_axis = np.hypot(local[:, 0], local[:, 1]) > 1e-6
    azimuths = np.arctan2(local[off_axis, 1], local[off_axis, 0])
    assert not is_in_opening(azimuths * (1.0 + 1e-9)).sum() > 0.05 * len(azimuths)
    assert len(cut.vertices) < len(whole.vertices)


@pytest.mark.parametrize(
    ("low", "high"), [(-math.pi, math.pi), (-2.8, 2.8), (0.0, 3.0), (-0.5, 0.4), (-6.0, 6.0)]
)
def test_what_is_left_is_what_is_not_in_the_open_sector(low, high):
    parts = open_intervals(low, high)
    for azimuth in np.linspace(low + 1e-3, high - 1e-3, 500):
        kept = any(first <= azimuth <= last for first, last in parts)
        assert kept != bool(is_in_opening(np.array(azimuth)))
    assert all(first < last for first, last in parts)


@pytest.mark.parametrize(
    ("robot", "why"),
    [("ur5e", "axes 4, 5 and 6 do not meet in one point."), ("panda", "this arm has 7 joints.")],
)
def test_an_arm_without_a_positioning_part_is_refused_in_words(robot, why):
    chain = load_robot(robot)
    with pytest.raises(BadValueError, match="spherical wrist") as caught:
        section_view(chain)
    sentence = why_no_section(chain, caught.value)
    assert sentence.startswith(f"No boundary: {why} It is drawn") and "expected" not in sentence


def test_limits_that_are_missing_are_named_as_the_reason():
    sliding = {"types": ["revolute", "prismatic", "prismatic"]}
    chain = chain_from_dh([0.1, 0.2, 0.3], [0.1] * 3, [0.0, 1.5, 0.3], **sliding)
    with pytest.raises(MissingLimitsError) as caught:
        section_view(chain)
    assert why_no_section(chain, caught.value) == f"No boundary: {caught.value}."


@pytest.mark.parametrize("orientations", ORIENTATIONS)
def test_points_have_the_values_of_the_map(orientations):
    chain = load_robot("ur5e")
    T, told = forward_kinematics(chain, chain.home()), []
    found = computed_map(chain, orientations, "coarse", T, lambda *done: told.append(done))
    assert told[-1] == (found.grid.cells, found.grid.cells)
    assert found.grid.shape == (DENSITIES["coarse"],) * 3
    whole = reach_points(found, MEASURES[1], cut=False)
    assert len(whole.points) == (found.reached > 0).sum() > 100
    rng = np.random.default_rng(1)
    for k in rng.choice(len(whole.points), 4, replace=False):
        count = 0
        for R in found.request.orientations:
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = R, whole.points[k]
            count += len(inverse_kinematics(chain, pose).q)
        assert count == whole.values[k]
    cut = reach_points(found, MEASURES[0], cut=True)
    assert 0 < len(cut.points) < len(whole.points)
    assert not is_in_opening(np.arctan2(cut.points[:, 1], cut.points[:, 0])).any()
    assert cut.values.max() <= 100.0 and cut.colours.shape == cut.points.shape
    index = reach_points(found, MEASURES[2], cut=False)
    assert np.nanmax(found.conditioning) * 100.0 == pytest.approx(index.values.max())
    assert index.values.max() <= index.high


def test_a_map_ends_by_what_progress_raises():
    class LeftOffError(Exception):
        pass

    def progress(_done, _total):
        raise LeftOffError

    chain = load_robot("general6r")
    with pytest.raises(LeftOffError):
        computed_map(chain, ORIENTATIONS[0], "fine", np.eye(4), progress)


@pytest.mark.parametrize(("orientations", "density"), [("none", "coarse"), (ORIENTATIONS[0], "x")])
def test_no_such_choice_is_refused(orientations, density):
    with pytest.raises(BadValueError, match="expected"):
        computed_map(load_robot("ur5e"), orientations, density, np.eye(4), lambda *_: None)


def test_of_a_map_where_nothing_is_reached_no_point_is_shown():
    chain = load_robot("ur5e")
    found = reach_map(chain, [5.0] * 3, [6.0] * 3, shape=3, orientations=2)
    for measure in MEASURES:
        assert not len(reach_points(found, measure, cut=False).points)
