"""Self-motion of redundant arms, and solutions along it."""
