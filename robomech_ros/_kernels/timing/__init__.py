"""Piecewise polynomials in time, and the speed along a path."""
