"""Performance indices, joint rates and singularities of a posture."""
