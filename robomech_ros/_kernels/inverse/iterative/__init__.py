"""Damped Newton steps from many starts, for chains that no other family takes."""
