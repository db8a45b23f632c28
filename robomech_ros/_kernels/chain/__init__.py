"""Serial chains: poses, Jacobians and their rates, reach."""
