"""Piecewise polynomials in time, and time-optimal speed along a path."""
