"""Inverse kinematics: every family of arms, and what they share."""
