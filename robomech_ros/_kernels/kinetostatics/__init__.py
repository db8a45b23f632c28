"""Indices, joint rates and singularities of a posture."""
