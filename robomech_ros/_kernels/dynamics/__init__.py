"""Recursions of Newton and Euler, composite bodies and their derivatives."""
