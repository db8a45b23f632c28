"""Bodies and friction from motions and measured torques."""
