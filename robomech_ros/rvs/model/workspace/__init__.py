"""Boundary and maps of the workspace of an arm."""
