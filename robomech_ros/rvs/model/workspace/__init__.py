"""Boundary and maps of what an arm reaches."""
