"""Chains that carry one platform: loop closure, rates, accelerations and dynamics."""
