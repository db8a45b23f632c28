"""Singular postures: what is lost there, how far they are, where there are none."""
