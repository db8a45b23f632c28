"""What RViz and others need to show a robot: its description, and its frames on /tf."""
