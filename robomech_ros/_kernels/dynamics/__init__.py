"""Newton-Euler recursions, composite and articulated bodies, and their derivatives."""
