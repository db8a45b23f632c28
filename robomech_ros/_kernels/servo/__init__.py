"""Look-ahead of the servo."""
