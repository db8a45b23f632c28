"""Fastest timing of a path within limits of joints, of the tip and of torques."""
