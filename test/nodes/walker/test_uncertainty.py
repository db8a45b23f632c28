"""Covariances of a walker's odometry: against feet that slip at random, and at rest."""

from itertools import pairwise

import numpy as np
import pytest

from robomech_ros.nodes.common.robot.odometry_frame import LEAST, UNMEASURED
from robomech_ros.nodes.walker.publication import Uncertainty
from robomech_ros.walking import Walker, load_legged

SLIP = 1e-4
DIAGONAL = [0, 7, 35]


def walked(gait, robot, seconds):
    walker = Walker(load_legged(robot), gait=gait, timeout=1e9, period=0.02)
    walker.command(walker.fastest * [0.4, 0.4, 0.1])
    return [walker.update() for _ in range(round(seconds / 0.02))]


def slipped(updates, rng, count):
    """Go the same way with feet that slip, and give where the trunk would think that it is."""
    pose = np.zeros((count, 3))
    for before, update in pairwise(updates):
        R, at = before.trunk[:2, :2], before.trunk[:2, 3]
        feet = (update.feet[update.contacts, :2] - at) @ R
        turn = R.T @ update.trunk[:2, :2]
        w = np.arctan2(turn[1, 0], turn[0, 0])
        ways = R.T @ (update.trunk[:2, 3] - at) + w * np.column_stack([-feet[:, 1], feet[:, 0]])
        deviation = np.sqrt(SLIP * np.linalg.norm(ways, axis=1))
        drawn = ways + deviation[:, None] * rng.normal(size=(count, *ways.shape))
        A = np.array([row for x, y in feet for row in ([-y, 1.0, 0.0], [x, 0.0, 1.0])])
        dw, dx, dy = np.linalg.lstsq(A, drawn.reshape(count, -1).T, rcond=None)[0]
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        pose += np.column_stack([c * dx - s * dy, s * dx + c * dy, dw])
    return pose


def test_the_covariance_is_that_of_feet_that_slip_at_random():
    updates, told = walked("tripod", "phantomx", 4.0), Uncertainty(SLIP)
    for update in updates:
        told.add(update, 0.02)
    drawn = np.cov(slipped(updates, np.random.default_rng(6), 4000), rowvar=False)
    stated = told.pose.reshape(6, 6)[np.ix_([0, 1, 5], [0, 1, 5])] - LEAST * np.eye(3)
    # Drawn variances are known to about 2 % by so many.
    root = np.linalg.inv(np.linalg.cholesky(stated))
    assert np.abs(root @ drawn @ root.T - np.eye(3)).max() < 0.1


@pytest.mark.parametrize(("gait", "robot"), [("wave", "phantomx"), ("crawl", "go1")])
def test_it_grows_with_the_way_and_not_at_rest(gait, robot):
    updates, told = walked(gait, robot, 6.0), Uncertainty(SLIP)
    at_rest = np.diag([LEAST, LEAST, *[UNMEASURED] * 3, LEAST]).ravel()
    assert np.array_equal(told.pose, at_rest) and np.array_equal(told.twist, at_rest)
    seen = []
    for update in updates:
        told.add(update, 0.02)
        seen.append(told.pose)
    full = np.array(seen)[:, DIAGONAL]
    assert (np.diff(full[::50].sum(axis=1)) > 0.0).all() and full[-1].min() > 0.0
    assert np.linalg.eigvalsh(told.pose.reshape(6, 6)).min() > 0.5 * LEAST
    assert (told.twist[DIAGONAL] > LEAST).all()
    for _ in range(10):
        told.add(updates[-1], 0.02)
    assert np.array_equal(told.pose, seen[-1]) and np.array_equal(told.twist, at_rest)
    told.forget()
    told.add(updates[0], 0.02)
    assert np.array_equal(told.pose, seen[-1])
