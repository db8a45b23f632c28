"""Robots other than arms, by kind, and their parts that a page can move."""
