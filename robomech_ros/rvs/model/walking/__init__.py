"""Walking machines on a page: where they stand, on which feet, and how safely."""
