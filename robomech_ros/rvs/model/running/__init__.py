"""Robots that run and move over the ground: as they are heard, and what a page asks of them."""
