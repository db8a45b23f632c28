"""Received joint states: positions, limits, and whether joints follow their commands."""
