"""Dynamics by other formulations than the recursions of the kernels, which check each other."""
