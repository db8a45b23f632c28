"""Kernels of wheeled robots."""
