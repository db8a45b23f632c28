"""Motions of parallel robots: along paths of the platform, and by places of the drives."""
