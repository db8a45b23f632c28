"""Slow, plain solvers of general six-revolute arms, to learn from and to check the fast one with.

They share no code with it: neither equations nor elimination, roots or refinement.  Their
steps one by one are in ``robomech_ros.kinematics.equations``.
"""

from robomech_ros.kinematics.oracles.bivariate import Intersection, minors, solve_bivariate
from robomech_ros.kinematics.oracles.posture_contours import Crossing, PostureContours
from robomech_ros.kinematics.oracles.univariate import UnivariateSolutions, solve_univariate

__all__ = [
    "Crossing",
    "Intersection",
    "PostureContours",
    "UnivariateSolutions",
    "minors",
    "solve_bivariate",
    "solve_univariate",
]
