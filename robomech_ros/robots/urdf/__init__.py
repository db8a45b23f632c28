"""URDF: documents read and checked, and written with bodies that can be seen."""
