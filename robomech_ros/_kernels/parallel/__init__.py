"""Parallel robots: all poses of the platform, and tracking of one pose."""
