"""Systems with as many, more or fewer equations than unknowns; curves of those in two unknowns."""

from robomech_ros.numerics.bivariate_roots import Bivariate, bivariate, refine_root
from robomech_ros.numerics.curve_pair import CurveCrossing, CurvePair
from robomech_ros.numerics.linear import least_squares, minimum_norm
from robomech_ros.numerics.nonlinear import Iteration, newton_gauss, newton_raphson

__all__ = [
    "Bivariate",
    "CurveCrossing",
    "CurvePair",
    "Iteration",
    "bivariate",
    "least_squares",
    "minimum_norm",
    "newton_gauss",
    "newton_raphson",
    "refine_root",
]
