"""Chains on a base that floats freely."""
