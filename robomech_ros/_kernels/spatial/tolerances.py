"""Tolerances of rotations, for kernels and for checks of input."""

# Deviation of a quaternion's norm from 1 that counts as rounding: messages written by hand have at
# least four digits.
UNIT_NORM = 1e-3
