"""How fast a path can be passed within limits of joints, of the tip and of torques."""
