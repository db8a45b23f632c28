"""Loops of all robots closed and followed; rates and accelerations against differences."""

import numpy as np
from mechanisms import postures_near_home

from robomech_ros._kernels.loops.rates import rates
from robomech_ros.outcomes import Code


def test_joints_are_counted_limb_by_limb(mechanism):
    names = [name for limb in mechanism.limbs for name in limb.chain.joint_names]
    assert list(mechanism.joint_names) == names
    assert [mechanism.joint_names[i] for i in mechanism.drive_index] == list(mechanism.actuated)
    assert sorted((*mechanism.actuated, *mechanism.passive)) == sorted(names)


def test_loops_are_closed_at_home_and_near_it(mechanism):
    q = np.array([mechanism.home(), *postures_near_home(mechanism, 50)])
    assert mechanism.loop_errors(q).max() <= 1e-12 * max(1.0, mechanism.size)


def test_closing_gives_the_drives_asked_for_to_the_last_bit(mechanism):
    given = mechanism.home()[mechanism.drive_index] + 1e-3
    closed = mechanism.close(given, mechanism.home())
    assert closed.status == Code.NONE
    assert closed.part == 1.0
    assert np.array_equal(closed.q[mechanism.drive_index], given)


def test_rates_are_differences_of_closed_postures(mechanism):
    rng = np.random.default_rng(2)
    for q in postures_near_home(mechanism, 5):
        wanted = rng.normal(size=mechanism.dof)
        qd, twist = mechanism.rates(q, wanted)
        h = 1e-6
        drives = q[mechanism.drive_index]
        after, before = (mechanism.close(drives + s * h * wanted, q).q for s in (1.0, -1.0))
        assert np.allclose((after - before) / (2.0 * h), qd, rtol=1e-5, atol=1e-7)
        change = (mechanism.pose(after) - mechanism.pose(before)) / (2.0 * h)
        turning = change[:3, :3] @ mechanism.pose(q)[:3, :3].T
        spin = np.array([turning[2, 1], turning[0, 2], turning[1, 0]])
        assert np.allclose(twist, [*spin, *change[:3, 3]], rtol=1e-5, atol=1e-7)
        N, V = mechanism.complement(q), mechanism.twist_matrix(q)
        assert np.allclose(N @ wanted, qd, rtol=1e-12, atol=1e-12)
        assert np.allclose(V @ wanted, twist, rtol=1e-12, atol=1e-12)


def test_accelerations_are_differences_of_rates(mechanism):
    rng = np.random.default_rng(3)
    for q in postures_near_home(mechanism, 5):
        speed, wanted = rng.normal(size=(2, mechanism.dof))
        qd, _ = mechanism.rates(q, speed)
        qdd, platform = mechanism.accelerations(q, qd, wanted)
        h = 1e-6
        drives = q[mechanism.drive_index]
        after, before = (
            mechanism.rates(
                mechanism.close(drives + s * h * speed + 0.5 * h * h * wanted, q).q,
                speed + s * h * wanted,
            )
            for s in (1.0, -1.0)
        )
        size = 1.0 + np.abs(qdd).max()
        assert np.abs((after[0] - before[0]) / (2.0 * h) - qdd).max() <= 1e-5 * size
        assert np.abs((after[1] - before[1]) / (2.0 * h) - platform).max() <= 1e-5 * size


def test_a_batch_is_its_rows(mechanism):
    q = postures_near_home(mechanism, 4)
    wanted = np.random.default_rng(4).normal(size=(4, mechanism.dof))
    qd, twists = mechanism.rates(q, wanted)
    qdd, platform = mechanism.accelerations(q, qd, wanted)
    for k in range(4):
        one = mechanism.rates(q[k], wanted[k])
        assert np.array_equal(qd[k], one[0])
        assert np.array_equal(twists[k], one[1])
        two = mechanism.accelerations(q[k], qd[k], wanted[k])
        assert np.array_equal(qdd[k], two[0])
        assert np.array_equal(platform[k], two[1])


def test_postures_and_modes_contain_the_posture_they_are_of(mechanism):
    for q in postures_near_home(mechanism, 5):
        found = mechanism.postures(mechanism.pose(q), seed=q)
        assert found.status == Code.NONE
        assert np.abs(found.q[0] - q).max() <= 1e-9
        assert mechanism.loop_errors(found.q).max() <= 1e-12 * max(1.0, mechanism.size)
        modes = mechanism.direct(q[mechanism.drive_index], seed=q)
        assert modes.complete or "nothing proves" in modes.reason
        assert np.abs(modes.poses[0] - mechanism.pose(q)).max() <= 1e-8 * max(1.0, mechanism.size)
        assert mechanism.loop_errors(modes.q).max() <= 1e-8 * max(1.0, mechanism.size)


def test_rates_are_written_for_as_many_columns_as_all_arrays_have(mechanism):
    """Twists of more columns than rates: nothing is written behind the rates."""
    loops, q = mechanism.loops, mechanism.home()
    given = np.eye(mechanism.dof)[None, :, :2].copy()
    n, twists = mechanism.n, np.full((1, 6, 5), np.nan)
    room = np.full(2 * n + 50, 7.0)
    out = room[: 2 * n].reshape(1, n, 2)
    chains = loops.packed, loops.starts, loops.drives, 1.0 / loops.size
    assert rates(*chains, q[None], given, out, twists) == 0
    assert (room[2 * n :] == 7.0).all() and np.isnan(twists[..., 2:]).all()
    np.testing.assert_array_equal(out[0], mechanism.complement(q)[:, :2])
    np.testing.assert_array_equal(twists[0, :, :2], mechanism.twist_matrix(q)[:, :2])
