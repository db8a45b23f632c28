"""The node rvs."""
