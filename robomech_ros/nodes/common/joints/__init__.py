"""Joints that are heard of: positions, limits, and whether they follow."""
