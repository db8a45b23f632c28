"""Sends trajectories to a controller, and watches what becomes of them."""
