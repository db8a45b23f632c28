"""Received joint states: positions, limits, and tracking of commands."""
