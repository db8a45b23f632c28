"""Paths: curves in space, poses along them, and joint paths that follow them."""
