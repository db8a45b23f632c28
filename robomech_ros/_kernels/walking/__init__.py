"""Kernels of walking machines: support, legs of three joints, one period of walking."""
