"""Kernels of calibrations."""
