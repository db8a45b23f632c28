"""Robots that are no arms, by their kinds: what of them is moved on a page."""
