"""Plots, where people would rather look than read.

Each function writes the picture to its first argument, whose ending (png, svg, pdf) gives the
format, puts the ``title`` above it, and returns the path. Without matplotlib, it raises
PlottingUnavailableError.
"""
