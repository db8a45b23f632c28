"""Bounds of the distances between the bodies of a robot and of the world around it."""
