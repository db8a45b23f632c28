"""Plots, where people would rather look than read; needs matplotlib."""
