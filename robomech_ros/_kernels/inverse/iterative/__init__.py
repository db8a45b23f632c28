"""Damped Newton steps from many starts, for chains of no other family."""
