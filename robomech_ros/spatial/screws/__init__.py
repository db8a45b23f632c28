"""Poses, lines and screws; velocities, accelerations, wrenches and inertia of rigid bodies."""
