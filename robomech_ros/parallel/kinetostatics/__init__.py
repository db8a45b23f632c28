"""Velocities, accelerations, forces, singularities and workspace of parallel robots."""
