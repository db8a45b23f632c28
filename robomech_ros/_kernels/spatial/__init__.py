"""Rotations, screws and points: chapters 2, 3 and 8 of the book."""
