"""Denavit-Hartenberg parameters recovered from chains give the same poses for every q."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, dh_from_chain, list_robots, load_robot

KINDS = (None, "general", "intersecting", "parallel", "antiparallel", "coincident")


def rebuilt(table):
    return chain_from_dh(
        table.a,
        table.b,
        table.alpha,
        table.theta,
        types=table.types.tolist(),
        base=table.base,
        tool=table.tool,
    )


def assert_same_poses(chain, other, seed=0, tolerance=1e-12):
    q = np.random.default_rng(seed).uniform(-3, 3, (50, chain.n))
    difference = forward_kinematics(chain, q) - forward_kinematics(other, q)
    assert np.abs(difference).max() < tolerance


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(30))
def test_random_chains(random_chain, kind, seed):
    chain = random_chain(seed, n=1 + seed % 8, kind=kind)
    # Two random directions may be nearly parallel: digits go with one over the sine.
    sines = [1.0] + [abs(np.sin(a)) for a in dh_from_chain(chain).alpha if abs(np.sin(a)) > 1e-8]
    assert_same_poses(chain, rebuilt(dh_from_chain(chain)), seed, 1e-12 / min(1.0, 10 * min(sines)))


@pytest.mark.parametrize("robot", list_robots())
def test_robots(robot):
    chain = load_robot(robot)
    assert_same_poses(chain, rebuilt(dh_from_chain(chain)))
    assert_same_poses(chain, rebuilt(chain.dh))


@pytest.mark.parametrize("robot", ["puma560", "diestro", "fanuc_arcmate", "general6r", "planar3r"])
def test_a_table_with_positive_lengths_comes_back_as_it_was(robot):
    chain = load_robot(robot)
    given, table = chain.dh, dh_from_chain(chain)
    for field in ("a", "b", "alpha", "theta", "base", "tool"):
        np.testing.assert_allclose(getattr(table, field), getattr(given, field), atol=1e-14)


def test_published_parameters_of_the_urdf_robots_come_back():
    table = load_robot("ur5e").dh
    np.testing.assert_allclose(table.a, [0, 0.425, 0.3922, 0, 0, 0], atol=1e-15)
    np.testing.assert_allclose(table.b, [0.1625, 0, 0, 0.1333, 0.0997, 0.0996], atol=1e-15)
    table = load_robot("irb120").dh
    np.testing.assert_allclose(table.a, [0, 0.27, 0.07, 0, 0, 0], atol=1e-15)
    np.testing.assert_allclose(table.b, [0.29, 0, 0, 0.302, 0, 0.072], atol=1e-15)


def test_nearly_parallel_axes_count_as_parallel():
    chain = chain_from_dh([0.3, 0.5, 0.2], [0.1, 0.2, 0.3], [1e-9, -3e-10, 0.0])
    table = dh_from_chain(chain)
    assert np.abs(table.b).max() < 1.0
    assert_same_poses(chain, rebuilt(dh_from_chain(chain)), tolerance=5e-9)


def test_tables_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        load_robot("ur5e").dh.a[0] = 1.0
