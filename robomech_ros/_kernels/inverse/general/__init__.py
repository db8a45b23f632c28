"""Inverse kinematics of general six-joint arms, a problem of degree sixteen."""
