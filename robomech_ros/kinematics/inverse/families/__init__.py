"""Solvers of arms, selected by geometry."""
