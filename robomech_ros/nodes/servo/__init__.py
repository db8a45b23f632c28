"""The node servo."""
