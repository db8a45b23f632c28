"""Laws of motion between two points."""
