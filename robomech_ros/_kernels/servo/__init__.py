"""The look-ahead of the servo."""
