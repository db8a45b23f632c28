"""Tolerances of rotations, for kernels and for checks of input."""

# Deviation of a quaternion's norm from 1 that is taken for rounding: messages written by hand
# carry four digits or more.
UNIT_NORM = 1e-3
