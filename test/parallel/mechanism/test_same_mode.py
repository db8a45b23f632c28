"""The assembly mode that is kept, against the one that is proved, and the one that is lost."""

import numpy as np
import pytest

from robomech_ros.kinetostatics import jacobian
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Planar3RRR, load_parallel


def test_closing_keeps_the_mode_that_following_proves():
    """Squared lengths and lengths move on different ways: moves are small enough for both."""
    rng = np.random.default_rng(9)
    kept = 0
    for name in ("hexapod", "dietmaier", "sgp_6_3"):
        robot = load_parallel(name)
        mechanism = robot.mechanism
        q = mechanism.home()
        T, drives = mechanism.pose(q), q[mechanism.drive_index]
        for _ in range(40):
            given = drives * (1.0 + 0.08 * rng.uniform(-1.0, 1.0, 6))
            proved = robot.follow(given, T)
            closed = mechanism.close(given, q)
            if proved.certified and closed.status == Code.NONE:
                assert np.abs(mechanism.pose(closed.q) - proved.pose).max() <= 1e-9
                kept += 1
    assert kept >= 60


def test_a_singularity_in_the_way_is_found_and_nothing_jumps_over_it():
    """Arms of a planar robot that are pulled apart until a limb is stretched."""
    mechanism = load_parallel("planar_3rrr").mechanism
    rng = np.random.default_rng(3)
    q = mechanism.home()
    lost = 0
    for _ in range(40):
        given = q[mechanism.drive_index] + rng.uniform(-2.0, 2.0, 3)
        closed = mechanism.close(given, q)
        assert mechanism.loop_errors(closed.q).max() <= 1e-12
        if closed.status == Code.NONE:
            assert closed.part == 1.0
            continue
        lost += 1
        assert closed.status == Code.SINGULAR
        assert 0.0 <= closed.part < 1.0
        assert "assembly modes meet" in closed.reason
        # As far as it went, the drives are on their way.
        way = given - q[mechanism.drive_index]
        gone = closed.q[mechanism.drive_index] - q[mechanism.drive_index]
        assert np.abs(gone - closed.part * way).max() <= 1e-9
        # Just before a singularity the twists of the drives are great.
        values = np.linalg.svd(mechanism.twist_matrix(closed.q), compute_uv=False)
        assert values[0] > 10.0 * np.linalg.svd(mechanism.twist_matrix(q), compute_uv=False)[0]
    assert lost >= 3


def test_the_way_back_from_a_singularity_is_free():
    """Right in front of one the first steps are tiny, and grow as the robot gets away from it."""
    mechanism = load_parallel("hexapod").mechanism
    home = mechanism.home()
    drives = home[mechanism.drive_index]
    ways = [
        [1.033, 0.209, 2.369, 0.999, 1.842, -1.451],
        [2.167, -0.381, -0.19, 1.076, -0.742, 2.909],
        [1.328, 1.014, 1.628, 0.962, 0.038, 1.126],
        [0.609, 1.007, 0.777, -0.726, -0.191, 1.372],
    ]
    for way in ways:
        stopped = mechanism.close(drives + way, home)
        assert stopped.status == Code.SINGULAR
        # On is refused as before, at a place that is hardly further.
        again = mechanism.close(drives + way, stopped.q)
        assert again.status == Code.SINGULAR
        assert again.part <= 1e-3
        back = mechanism.close(drives, stopped.q)
        assert back.status == Code.NONE
        assert np.abs(back.q - home).max() <= 1e-9


@pytest.mark.parametrize("name", ["agile_eye", "delta", "hexapod"])
def test_a_long_way_ends_in_the_mode_in_which_short_ones_end(name):
    """One call for turns of up to 2 rad, or for half of the strokes, against 200 calls."""
    rng = np.random.default_rng(5)
    mechanism = load_parallel(name).mechanism
    q = mechanism.home()
    drives = q[mechanism.drive_index]
    reach = 0.15 if name == "hexapod" else 2.0
    for _ in range(60):
        way = reach * rng.uniform(-1.0, 1.0, mechanism.dof)
        closed = mechanism.close(drives + way, q)
        if closed.status != Code.NONE:
            continue
        assert np.array_equal(closed.q[mechanism.drive_index], drives + way)
        near = q
        for part in np.linspace(0.0, 1.0, 201)[1:]:
            short = mechanism.close(drives + part * way, near)
            assert short.status == Code.NONE
            near = short.q
        np.testing.assert_allclose(mechanism.pose(closed.q), mechanism.pose(near), atol=1e-9)


def _conditions(mechanism, q):
    """Return limb end conditions of passive joints and a platform twist, (k, 6 l, p)."""
    loops, starts = mechanism.loops, mechanism.loops.starts
    blocks = []
    for i, limb in enumerate(mechanism.limbs):
        own = slice(starts[i], starts[i + 1])
        free = np.flatnonzero(loops.drives[own] < 0)
        J = jacobian(limb.chain, q[:, own])[..., free] / loops.weights[own][free]
        J[:, 3:] /= loops.size
        rows = np.zeros((len(q), 6 * len(mechanism.limbs), len(free)))
        rows[:, 6 * i : 6 * i + 6] = J
        blocks.append(rows)
    platform = np.tile(np.eye(6), (len(q), len(mechanism.limbs), 1))
    return np.concatenate([*blocks, platform], axis=2)


@pytest.mark.parametrize("name", ["agile_eye", "delta", "planar_3rrr", "planar_3rpr"])
def test_no_way_goes_through_a_singularity(name):
    """Between neighbours of 500 postures the determinant of the loops keeps its sign."""
    rng = np.random.default_rng(7)
    mechanism = load_parallel(name).mechanism
    q = mechanism.home()
    drives = q[mechanism.drive_index]
    kept = stopped = 0
    for _ in range(24):
        way = rng.uniform(0.1, 5.0) * rng.uniform(-1.0, 1.0, 3)
        closed = mechanism.close(drives + way, q)
        assert closed.status in (Code.NONE, Code.SINGULAR)
        rows = [q]
        for part in np.linspace(0.0, closed.part, 501)[1:]:
            rows.append(mechanism.close(drives + part * way, rows[-1]).q)
        np.testing.assert_allclose(rows[-1], closed.q, atol=1e-6)
        M = _conditions(mechanism, np.array(rows))
        assert (np.linalg.det(np.swapaxes(M[:-1], 1, 2) @ M[1:]) > 0.0).all()
        kept += closed.status == Code.NONE
        stopped += closed.status == Code.SINGULAR
    assert kept >= 3
    assert stopped >= 1


def test_a_way_too_long_for_one_call_is_said():
    mechanism = load_parallel("delta").mechanism
    q = mechanism.home()
    closed = mechanism.close(q[mechanism.drive_index] + 1e6, q)
    assert closed.status in (Code.SINGULAR, Code.NOT_CONVERGED)
    assert closed.part < 1.0
    assert closed.reason
    assert mechanism.loop_errors(closed.q).max() <= 1e-12


def test_lengths_do_not_jump_through_zero():
    """At -1 times the lengths the loops close as well, but a singularity is in between."""
    mechanism = load_parallel("hexapod").mechanism
    q = mechanism.home()
    for factor in (0.0, -0.5, -1.0, -1.2):
        closed = mechanism.close(factor * q[mechanism.drive_index], q)
        assert closed.status == Code.SINGULAR
        assert mechanism.pose(closed.q)[2, 3] > 0.0
        assert abs(closed.part * (1.0 - factor) - 0.1866) < 1e-3


@pytest.mark.parametrize("far", [1e2, 1e4, 1e300])
def test_drives_that_are_far_away_are_reached_or_refused(far):
    for name in ("delta", "planar_3rpr", "agile_eye"):
        mechanism = load_parallel(name).mechanism
        q = mechanism.home()
        given = q[mechanism.drive_index] + far
        closed = mechanism.close(given, q)
        assert mechanism.loop_errors(closed.q).max() <= 1e-12
        if closed.status == Code.NONE:
            assert np.array_equal(closed.q[mechanism.drive_index], given)


def test_open_loops_that_do_not_close_are_said():
    mechanism = load_parallel("hexapod").mechanism
    q = mechanism.home()
    torn = q.copy()
    torn[mechanism.joint_names.index("leg1_base_x")] += 2.5
    closed = mechanism.close(q[mechanism.drive_index], torn)
    assert closed.status == Code.NOT_CONVERGED
    assert "loops of the posture given are open" in closed.reason
    assert np.array_equal(closed.q, torn)


def test_rounding_does_not_choose_between_homes_that_mirror_each_other():
    rng = np.random.default_rng(2)
    given = load_parallel("planar_3rrr")
    home = given.mechanism.home()
    for _ in range(8):
        noise = 1e-14 * rng.normal(size=(2, 3, 2))
        points = given.base_points + noise[0], given.platform_points + noise[1]
        robot = Planar3RRR(*points, given.proximal, given.distal)
        assert np.abs(robot.mechanism.home() - home).max() <= 1e-9
