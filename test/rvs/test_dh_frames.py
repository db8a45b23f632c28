"""Denavit-Hartenberg frames as they are drawn: axes, offsets and common normals of a posture."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot
from robomech_ros.rvs.model.arms.dh_editing import table_of
from robomech_ros.rvs.model.arms.dh_frames import dh_frames


def distance(first, second):
    """Distance of two lines, each a point and a direction: parallel or not."""
    (p, u), (q, v) = first, second
    across = np.cross(u, v)
    if np.linalg.norm(across) < 1e-7:
        return np.linalg.norm(np.cross(q - p, u))
    return abs((q - p) @ across) / np.linalg.norm(across)


def joint_lines(chain, q):
    """Point and direction of each joint axis, by differences of the tip's pose."""
    lines, step = [], 1e-6
    for k in range(chain.n):
        before, after = (
            forward_kinematics(chain, q + h * np.eye(chain.n)[k]) for h in (-step, step)
        )
        rate = (after - before) / (2.0 * step)
        if chain.types[k]:
            lines.append((np.zeros(3), rate[:3, 3]))
            continue
        R = 0.5 * (after + before)
        spin = rate[:3, :3] @ R[:3, :3].T
        axis = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        lines.append((R[:3, 3] + np.cross(axis, rate[:3, 3]), axis))
    return lines


@pytest.mark.parametrize("name", ["puma560", "ur5e", "scara", "stanford"])
def test_lines_are_those_of_the_joints(name):
    chain = load_robot(name)
    table, rng = table_of(chain), np.random.default_rng(7)
    for q in rng.uniform(np.fmax(chain.lower, -2.0), np.fmin(chain.upper, 2.0), (5, chain.n)):
        found = dh_frames(table, q, 1.0)
        tip = found.frames[-1] @ table.tool
        assert tip == pytest.approx(forward_kinematics(chain, q), abs=1e-9)
        joints = joint_lines(chain, q)
        for k in range(chain.n):
            own = joints[k]
            for end in (*found.axes[k], *found.offsets[k], found.normals[k, 0]):
                if chain.types[k] == 0:
                    # Axes of sliding joints may lie anywhere along their direction.
                    assert np.linalg.norm(np.cross(end - own[0], own[1])) < 1e-8
            along = found.axes[k, 1] - found.axes[k, 0]
            assert along / np.linalg.norm(along) == pytest.approx(own[1], abs=1e-8)
            if k + 1 < chain.n and (chain.types[k : k + 2] == 0).all():
                after = joints[k + 1]
                normal = found.normals[k, 1] - found.normals[k, 0]
                assert np.linalg.norm(normal) == pytest.approx(distance(own, after), abs=1e-8)
                assert normal @ own[1] == pytest.approx(0.0, abs=1e-8)
                assert normal @ after[1] == pytest.approx(0.0, abs=1e-8)


def test_lengths_are_named_where_there_are_any():
    chain = load_robot("puma560")
    table = table_of(chain)
    names = dh_frames(table, np.zeros(6), 1.0).names
    assert [f"Z{k}" in names for k in range(1, 7)] == [True] * 6
    assert f"a2 = {table.a[1]:.4g} m" in names
    lengths = sum(abs(x) > 1e-9 for x in (*table.a, *table.b))
    assert len(names) == 6 + lengths
