"""The node dynamics."""
