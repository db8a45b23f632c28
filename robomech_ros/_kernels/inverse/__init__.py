"""Inverse kinematics: every family of arms, and their common parts."""
