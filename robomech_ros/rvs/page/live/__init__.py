"""Page parts for a running robot: messages from it, and hold-to-run buttons."""
