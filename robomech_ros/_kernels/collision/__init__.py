"""Bounds of distances between the bodies of a robot, and to bodies of its environment."""
