"""Tolerances of rotations that the kernels share with those who check what comes from outside."""

# Deviation of a quaternion's norm from 1 that is taken for rounding: messages written by hand
# carry four digits or more.
UNIT_NORM = 1e-3
