"""Hands: the wrenches of contacts, and whether they close a grasp."""
