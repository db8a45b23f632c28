"""Motions in time: under given torques, and under a controller."""
