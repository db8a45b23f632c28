"""Checked input of inverse kinematics: request, target pose, task."""
