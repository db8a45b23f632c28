"""Closed-form solutions of arms with a spherical wrist."""
