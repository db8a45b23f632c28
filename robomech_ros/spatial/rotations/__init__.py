"""Rotations: their representations, rates, composition and reflections."""
