"""Parts of the servo."""
