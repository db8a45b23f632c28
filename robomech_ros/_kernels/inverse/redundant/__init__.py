"""Inverse kinematics of arms with more than six joints: samples and traces of self-motions."""
