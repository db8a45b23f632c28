"""Dynamics of parallel robots, by the natural orthogonal complement of their loops."""
