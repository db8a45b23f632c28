"""Demonstration of ``robomech demo``: a pick and place with every part of the suite."""
