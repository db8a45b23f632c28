"""Straight drives from random postures until the tip stands, and what they did."""

from typing import NamedTuple

import numpy as np
from servo_drives import LENGTHS, Drive, robot_of

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.kinetostatics.singularities.generic_rank import scaling_length

# Slow ones last this long (s).
LONGEST = 8.0
# Begun no nearer to a singularity than this condition number.
REGULAR = 60.0
# Rates below this (rad/s or m/s) are standing.
STANDING = 1e-9


class Approach(NamedTuple):
    """A drive, what it left its line by (m and rad), and whether it stands at its end."""

    drive: Drive
    off: float
    turned: float
    stands: bool


def deviation(drive, direction, first=0):
    """Return by how much the tip left the line through one of its places (m), and turned (rad)."""
    poses = forward_kinematics(drive.chain, np.array(drive.positions[first:]))
    way = poses[:, :3, 3] - poses[0, :3, 3]
    off = np.linalg.norm(way - np.outer(way @ direction, direction), axis=1)
    R = poses[:, :3, :3] @ poses[0, :3, :3].T - np.eye(3)
    return off.max(), np.linalg.norm(R, axis=(1, 2)).max() / np.sqrt(2.0)


def length_of(robot):
    if robot not in LENGTHS:
        LENGTHS[robot] = scaling_length(robot_of(robot), None)
    return LENGTHS[robot]


def random_start(robot, rng):
    """Return a regular posture and a direction in which the tip can move without turning."""
    chain, length = robot_of(robot), length_of(robot)
    low, high = np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi)
    while True:
        q = rng.uniform(0.95 * low + 0.05 * high, 0.05 * low + 0.95 * high)
        scaled = jacobian(chain, q) / np.repeat((1.0, length), 3)[:, None]
        left, values, _ = np.linalg.svd(scaled)
        rank = np.linalg.matrix_rank(scaled)
        if values[0] > REGULAR * values[rank - 1] or rank < min(chain.n, 6) - 1:
            continue
        # Translations without a part that no joint rates have.
        _, parts, ways = np.linalg.svd(left[3:, rank:].T)
        free = ways[np.count_nonzero(parts > 1e-9) :]
        if len(free):
            direction = rng.normal(size=len(free)) @ free
            return q, direction / np.linalg.norm(direction)


def approach(robot, q, direction, speed, period=0.01):
    """Drive until the tip stands."""
    drive = Drive(robot, q, length=length_of(robot), period=period)
    twist = np.concatenate((np.zeros(3), speed * direction))
    stands = False
    while not stands and drive.time < LONGEST:
        drive.twist(twist, 0.2)
        stands = np.abs(drive.velocities[-10:]).max() < STANDING
    return Approach(drive, *deviation(drive, direction), stands)
