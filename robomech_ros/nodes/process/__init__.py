"""Processes: how nodes start, run and end."""
