"""Hands: wrenches of contacts, and closure of grasps."""
