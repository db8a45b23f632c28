"""Inverse kinematics: all solutions, or the reason why there is none."""
