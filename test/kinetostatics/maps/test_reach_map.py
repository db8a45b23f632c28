"""Maps of reach and dexterity, against single calls; what is refused; interruption."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from robomech_ros._kernels.inverse.solutions import UNDECIDED
from robomech_ros.errors import BadValueError, NonFiniteError, NotEnoughMemoryError, WrongSizeError
from robomech_ros.kinematics import inverse_kinematics
from robomech_ros.kinematics.inverse.closed_form import solve_many
from robomech_ros.kinetostatics import (
    condition_number,
    load_reach_map,
    reach_map,
    uniform_rotations,
    uniform_turns,
)
from robomech_ros.numerics.memory import available_memory
from robomech_ros.robots import load_robot
from robomech_ros.spatial import matrix_from_roll_pitch_yaw
from test.coupled_robots import coupled

PUMA = load_robot("puma560")
# Box, shape and orientations, in each of which some poses are reached and some are not.
DOWN = matrix_from_roll_pitch_yaw([np.pi, 0.0, 0.0])
CASES = {
    "puma560": ([0.2, -0.5, -0.2], [0.8, 0.5, 0.6], (3, 2, 2), uniform_rotations(5)),
    "ur5e": ([-0.6, -0.6, 0.1], [0.6, 0.6, 0.7], (2, 2, 2), uniform_rotations(5)),
    "jaco2": ([-0.4, -0.4, 0.1], [0.4, 0.4, 0.5], (2, 2, 2), uniform_rotations(5)),
    "scara": ([0.2, -0.3, 0.2], [0.6, 0.3, 0.3], (3, 2, 2), uniform_turns(4, [0, 0, 1], DOWN)),
    "planar3r": ([0.0, 0.1, 0.0], [2.0, 1.1, 0.0], (4, 3, 1), uniform_turns(6, [0, 0, 1])),
    "panda": ([0.3, -0.3, 0.2], [0.7, 0.3, 0.7], (2, 2, 2), uniform_rotations(3)),
}


@pytest.mark.parametrize("name", CASES)
def test_cells_are_what_single_calls_give(name):
    chain = load_robot(name)
    lower, upper, shape, turns = CASES[name]
    found = reach_map(chain, lower, upper, shape=shape, orientations=turns, length=0.3)
    assert found.complete
    assert 0 < found.share_reached < 1
    best_of_all, reciprocals = np.inf, []
    for place in np.ndindex(*shape):
        T = np.tile(np.eye(4), (len(turns), 1, 1))
        T[:, :3, :3] = turns
        T[:, :3, 3] = [axis[i] for axis, i in zip(found.grid.axes, place, strict=True)]
        results = [inverse_kinematics(chain, one) for one in T]
        best = [
            condition_number(chain, one.q, length=0.3).min() if len(one) else np.nan
            for one in results
        ]
        reached = [len(one) > 0 for one in results]
        assert found.reached[place] == sum(reached), place
        assert found.dexterity[place] == sum(reached) / len(turns)
        assert found.solutions[place] == sum(map(len, results))
        if not any(reached):
            assert np.isnan(found.condition_number[place])
            assert np.isnan(found.conditioning[place])
            continue
        reciprocals += [1.0 / value for value in best if not np.isnan(value)]
        assert found.condition_number[place] == pytest.approx(np.nanmin(best), rel=1e-9)
        assert found.conditioning[place] == pytest.approx(1.0 / np.array(best)[reached] @ np.ones(
            sum(reached)) / sum(reached), rel=1e-9)  # fmt: skip
        best_of_all = min(best_of_all, np.nanmin(best))
    assert found.best_condition_number == pytest.approx(best_of_all, rel=1e-9)
    assert found.mean_conditioning == pytest.approx(np.mean(reciprocals), rel=1e-9)


def test_poses_that_a_family_cannot_decide_are_searched(monkeypatch):
    box = {"lower": [0.3, -0.4, 0.1], "upper": [0.7, 0.4, 0.5], "shape": 2, "orientations": 4}
    wanted = reach_map(PUMA, **box, length=0.3)

    def undecided(*arguments):
        q, counts, state = solve_many(*arguments)
        q[::2], counts[::2] = np.nan, UNDECIDED
        return q, counts, state

    monkeypatch.setattr("robomech_ros.kinetostatics.maps.cells.solve_many", undecided)
    found = reach_map(PUMA, **box, length=0.3)
    assert found.share_reached > 0.0
    assert found.cells.tobytes() == wanted.cells.tobytes()


def test_limits_parts_and_length_count():
    box = {"lower": [-0.8] * 3, "upper": [0.8] * 3, "shape": 4, "orientations": 6}
    within = reach_map(PUMA, **box, length=0.3)
    beyond = reach_map(PUMA, **box, length=0.3, respect_limits=False)
    assert (beyond.reached >= within.reached).all()
    assert beyond.share_reached > within.share_reached
    assert set(np.unique(beyond.solutions % 8)) == {0}
    part = reach_map(PUMA, **box, part="orientation")
    assert part.request.length == pytest.approx(0.283, abs=1e-3), "the characteristic length"
    assert (part.condition_number[part.reached > 0] < within.condition_number[within.reached > 0])\
        .all()  # fmt: skip


def test_it_does_not_depend_on_the_number_of_threads():
    box = {"lower": [-0.9] * 3, "upper": [0.9] * 3, "shape": 10, "orientations": 80, "length": 0.3}
    maps = [reach_map(PUMA, **box, workers=count) for count in (1, 2, 5)]
    assert len({one.cells.tobytes() for one in maps}) == 1


def test_points_begin_at_the_lower_bound_and_do_not_pass_the_upper():
    one = {"orientations": 1, "length": 1.0}
    found = reach_map(PUMA, [0.1, 0.0, 0.0], [0.7, 0.25, 0.0], spacing=0.1, **one)
    x, y, z = found.grid.axes
    assert np.allclose(x, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
    assert np.allclose(y, [0.0, 0.1, 0.2])
    assert z.tolist() == [0.0]
    assert found.reached.shape == (7, 3, 1)
    other = reach_map(PUMA, [0.1, 0.0, 0.0], [0.7, 0.2, 0.0], shape=(7, 3, 1), **one)
    assert np.array_equal(found.reached, other.reached)


@pytest.mark.parametrize("count", [1, 2, 60, 1000])
def test_rotations_are_spread_evenly(count):
    R = uniform_rotations(count)
    assert np.array_equal(R, uniform_rotations(count))
    assert np.allclose(R @ R.transpose(0, 2, 1), np.eye(3), atol=1e-14)
    assert np.allclose(np.linalg.det(R), 1.0)
    if count < 60:
        return
    cosine = 0.5 * (np.einsum("aij,bij->ab", R, R) - 1.0)
    nearest = np.arccos(np.clip(cosine - 3.0 * np.eye(count), -1.0, 1.0)).min(axis=1)
    # Balls of half that radius around all would fill SO(3): its volume is 8 pi^2, that of a ball
    # of radius a is 8 pi (a - sin a).
    radius = np.cbrt(6.0 * np.pi / count)
    assert nearest.min() > 0.9 * radius
    assert np.abs(R.mean(axis=0)).max() < 3.0 / count


def test_turns_go_once_around_the_axis():
    R = uniform_turns(4, [0, 0, 2], DOWN)
    assert np.allclose(R[0], DOWN)
    assert np.allclose(R[1] @ [1, 0, 0], [0, 1, 0])
    assert np.allclose(R[:, 2, 2], -1.0)


GOOD = {"lower": [0, 0, 0], "upper": [1, 1, 1], "shape": 2, "orientations": 1, "length": 0.3}


@pytest.mark.parametrize(
    ("bad", "error", "text"),
    [
        ({"lower": [0, np.nan, 0]}, NonFiniteError, r"lower\[1\] is nan"),
        ({"upper": [0, 0, np.inf]}, NonFiniteError, r"upper\[2\] is inf"),
        ({"lower": [0, 2, 0]}, BadValueError, r"lower\[1\] \(y\) is 2.0, expected at most"),
        ({"lower": [0, 2]}, WrongSizeError, r"lower has shape \(2,\)"),
        ({"upper": [0, 0, 1e7]}, BadValueError, r"at most 1e\+06 m"),
        ({"shape": None, "spacing": 0.0}, BadValueError, "spacing is 0.0, expected a positive"),
        ({"shape": None, "spacing": [1, -1, 1]}, BadValueError, "expected a positive distance"),
        ({"shape": None, "spacing": np.nan}, NonFiniteError, "spacing is nan"),
        ({"shape": None}, BadValueError, "spacing and shape is 'neither'"),
        ({"spacing": 0.1}, BadValueError, "spacing and shape is 'both'"),
        ({"shape": (2, 0, 2)}, BadValueError, "whole numbers of at least 1"),
        ({"shape": 1.5}, BadValueError, "whole numbers of at least 1"),
        ({"shape": (2, 2, 1)}, BadValueError, r"shape\[2\] \(z\) is 1, expected at least 2"),
        ({"orientations": 0}, BadValueError, "number of orientations is 0"),
        ({"orientations": 10**9}, BadValueError, "from 1 to 1,000,000"),
        ({"orientations": np.eye(3)}, WrongSizeError, "orientations"),
        ({"orientations": 2.0 * np.ones((1, 3, 3))}, BadValueError, "orientations in row 0"),
        ({"part": "all"}, BadValueError, "part is 'all'"),
        ({"length": -1.0}, BadValueError, "length is -1.0"),
        ({"workers": 0}, BadValueError, "workers is 0"),
        ({"progress": "bar"}, BadValueError, "progress is 'bar', expected a function"),
        ({"file": 3}, BadValueError, "file is 3, expected the path of a file"),
        ({"respect_limits": "no"}, BadValueError, "respect_limits is 'no'"),
    ],
)
def test_what_is_wrong_is_said(bad, error, text):
    with pytest.raises(error, match=text):
        reach_map(PUMA, **(GOOD | bad))


@pytest.mark.parametrize("shape", [100_000, 10**18])
def test_a_grid_that_does_not_fit_is_told_beforehand(shape):
    with pytest.raises(NotEnoughMemoryError, match=r"bytes of memory, of which [\d,]+ bytes are"):
        reach_map(PUMA, **(GOOD | {"shape": shape}))
    with pytest.raises(NotEnoughMemoryError) as caught:
        reach_map(PUMA, **(GOOD | {"shape": None, "spacing": 1e-300}))
    assert len(str(caught.value)) < 200
    assert 0 < caught.value.available <= available_memory() * 2


def test_an_interruption_keeps_what_is_finished_and_the_same_call_goes_on(tmp_path):
    file = tmp_path / "map.npz"
    box = GOOD | {"shape": 8, "orientations": 250, "lower": [-1, -1, -1]}
    whole = reach_map(PUMA, **box)

    def interrupt(done, total):
        if 0 < done < total:
            raise KeyboardInterrupt

    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            reach_map(PUMA, **box, file=file, progress=interrupt, workers=1)
    part = load_reach_map(file, PUMA)
    assert 0 < part.finished < whole.grid.cells
    assert not part.complete
    known = part.reached >= 0
    assert np.isnan(part.dexterity[~known]).all()
    assert np.array_equal(part.reached[known], whole.reached[known])
    steps = []
    again = reach_map(PUMA, **box, file=file, progress=lambda done, total: steps.append(done))
    assert again.cells.tobytes() == whole.cells.tobytes() == load_reach_map(file).cells.tobytes()
    assert steps[0] == part.finished
    assert steps[-1] == whole.grid.cells
    assert threading.active_count() < 20
    assert list(tmp_path.iterdir()) == [file]
    steps.clear()
    reach_map(PUMA, **box, file=file, progress=lambda done, total: steps.append(done))
    assert steps == [whole.grid.cells], "nothing is computed twice"


def test_the_same_arm_under_another_name_is_another_robot(tmp_path):
    file = tmp_path / "map.npz"
    reach_map(PUMA, **GOOD, file=file)
    with pytest.raises(ValueError, match="it is of robot 'puma560'.*, not 'copy'"):
        load_reach_map(file, replace(PUMA, name="copy"))


def palletizer_postures(x, y, z, yaw):
    """Postures of the palletizer inside its limits, by the law of cosines in its plane."""
    count = 0
    for away, turn in ((np.hypot(x, y), np.arctan2(y, x)), (-np.hypot(x, y), np.arctan2(-y, -x))):
        # From the shoulder to the wrist; the hand stays level.
        u, w = away - 0.06, z - 0.14 + 0.05
        cosine = (u**2 + w**2 - 0.135**2 - 0.147**2) / (2.0 * 0.135 * 0.147)
        for spin in yaw - turn + 2.0 * np.pi * np.arange(-2, 3):
            for bend in (-np.arccos(cosine), np.arccos(cosine)) if abs(cosine) < 1.0 else ():
                low = np.arctan2(w, u) - np.arctan2(
                    0.147 * np.sin(bend), 0.135 + 0.147 * np.cos(bend)
                )
                rear, fore = np.remainder(np.pi / 2 - low + 1.0, 2 * np.pi) - 1.0, -low - bend
                fore = np.remainder(fore + np.pi, 2 * np.pi) - np.pi
                inside = 0.0 <= rear <= 1.4 and -0.2 <= fore <= 1.4
                count += inside and abs(turn) <= 2.2 and abs(spin) <= 3.0
    return count


@pytest.mark.slow
def test_a_map_of_a_palletizer_counts_the_postures_of_its_drives():
    chain, angles = coupled("palletizer"), np.array([0.3, 2.0])
    c, s = np.cos(angles), np.sin(angles)
    turned = np.tile(np.eye(3), (2, 1, 1))
    turned[:, 0, 0], turned[:, 0, 1], turned[:, 1, 0], turned[:, 1, 1] = c, -s, s, c
    made = reach_map(
        chain, (-0.3, -0.3, 0.0), (0.3, 0.3, 0.3), shape=(6, 6, 6), orientations=turned, workers=1
    )
    expected = np.array([
        [palletizer_postures(*point, yaw) for yaw in angles]
        for point in made.grid.points(np.arange(made.grid.cells))
    ])  # fmt: skip
    assert np.count_nonzero(expected) > 50
    np.testing.assert_array_equal(made.reached.ravel(), np.count_nonzero(expected, axis=1))
    np.testing.assert_array_equal(made.solutions.ravel(), expected.sum(axis=1))
