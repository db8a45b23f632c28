"""Kernels of rolling robots."""
