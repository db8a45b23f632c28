"""Walking machines on a page: position, standing feet, and stability."""
