"""Arms with more than six joints: their self-motion, sampled and followed."""
