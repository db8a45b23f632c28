"""Frames that goals name: those of the robot, and those of tf."""
