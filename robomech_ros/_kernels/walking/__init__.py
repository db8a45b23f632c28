"""Kernels of walking machines: support margin, legs of three joints, and gait steps."""
