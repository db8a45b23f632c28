"""Kernels of hand-eye calibration."""
