"""Angles, polynomials, small linear systems and singular values."""
