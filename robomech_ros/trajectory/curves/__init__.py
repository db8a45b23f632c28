"""Curves as piecewise polynomials: splines, bounds, samples, scaling in time."""
