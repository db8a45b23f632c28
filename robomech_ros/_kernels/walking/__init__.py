"""Kernels of walking machines: support by feet on the ground."""
