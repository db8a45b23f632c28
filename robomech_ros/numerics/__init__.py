"""Linear and nonlinear systems with as many, more or fewer equations than unknowns."""

from robomech_ros.numerics.linear import least_squares, minimum_norm
from robomech_ros.numerics.nonlinear import Iteration, newton_gauss, newton_raphson

__all__ = ["Iteration", "least_squares", "minimum_norm", "newton_gauss", "newton_raphson"]
