"""Robots that run: what they report, and what is asked of them."""
