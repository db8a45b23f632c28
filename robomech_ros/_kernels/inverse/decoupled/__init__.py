"""Arms with a spherical wrist, in closed form."""
