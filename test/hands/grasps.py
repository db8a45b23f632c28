"""Grasps that tests share: those of known quality, and random ones."""

import numpy as np

from robomech_ros.hands import Contact

__all__ = ["CUBE", "EQUATOR", "TETRAHEDRON", "disc", "on_sphere", "opposed", "random_sphere"]

CUBE = np.vstack([np.eye(3), -np.eye(3)])
TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0)
EQUATOR = np.array([[np.cos(a), np.sin(a), 0.0] for a in 2.0 * np.pi * np.arange(3) / 3.0])


def disc(count, friction, model="point"):
    """Contacts evenly spaced on a disc of radius 1, in the plane."""
    angles = 2.0 * np.pi * np.arange(count) / count
    rim = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return [Contact(p, -p, model, friction) for p in rim]


def on_sphere(points, friction, model="point", torsional=0.0):
    """Contacts that press towards the origin."""
    return [Contact(p, -np.asarray(p), model, friction, torsional) for p in points]


def random_sphere(rng, count, friction, model="point", torsional=0.0):
    points = rng.normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    return on_sphere(points, friction, model, torsional)


def opposed(model, friction=0.0, torsional=0.0):
    """Two contacts opposite each other on a sphere of radius 1."""
    return on_sphere([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], friction, model, torsional)
