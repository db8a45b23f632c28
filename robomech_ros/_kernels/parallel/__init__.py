"""Parallel robots: all poses of the platform, and one that is followed."""
