"""Postures of the first three joints of a decoupled arm, one a row.

A row holds the joint values (angles in rad, displacements in units of SIZE), the flags of free
joints, the determinant of the Jacobian over the largest one, and cosine and sine of every angle,
which saves trigonometric functions; for a slide they are 1 and 0.
"""

import math

from robomech_ros._kernels.algebra.angles import angle_of
from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.inverse.decoupled import layout as at

FREE = 3
DETERMINANT = 4
_TURNS = 5  # cosine and sine of joint 1, of joint 2, of joint 3
WIDTH = 11

# Flags of free joints, in the direction of solution.
FREE_1 = 1
FREE_2 = 2
FREE_3 = 4


@lean
def cosine_of(row, j):
    """Return the cosine of joint j."""
    return row[_TURNS + 2 * j]


@lean
def sine_of(row, j):
    """Return the sine of joint j."""
    return row[_TURNS + 2 * j + 1]


@lean
def enter_turn(row, j, cosine, sine):
    """Enter cosine and sine of joint j; :func:`add_angles` adds the angle."""
    row[_TURNS + 2 * j] = cosine
    row[_TURNS + 2 * j + 1] = sine


@lean
def enter_slide(row, j, value):
    """Enter the displacement of joint j."""
    row[j] = value
    row[_TURNS + 2 * j] = 1.0
    row[_TURNS + 2 * j + 1] = 0.0


@lean
def add_angles(data, row, free):
    """Add the angles of revolute joints, those of free joints from ``free``."""
    flags = int(row[FREE])
    for j in range(3):
        if data[at.TYPES + j] == 0.0:
            angle = angle_of(row[_TURNS + 2 * j + 1], row[_TURNS + 2 * j])
            row[j] = free[j] if flags >> j & 1 else angle


@lean
def update_cosines(data, row):
    """Update cosines and sines from the angles."""
    for j in range(3):
        if data[at.TYPES + j] == 0.0:
            row[_TURNS + 2 * j] = math.cos(row[j])
            row[_TURNS + 2 * j + 1] = math.sin(row[j])


@lean
def copy_row(source, row):
    """Copy a posture to ``row``."""
    for i in range(WIDTH):
        row[i] = source[i]
