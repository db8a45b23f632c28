"""Chains on a free-floating base."""
