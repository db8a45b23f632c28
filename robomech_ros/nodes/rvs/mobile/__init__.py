"""Robots that run over the ground: heard, and commanded by twists."""
