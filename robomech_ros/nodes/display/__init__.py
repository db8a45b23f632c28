"""Robot description and frames on /tf for RViz and other viewers."""
