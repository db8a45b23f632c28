"""The equations of section 10.2 of the book as plain functions that return its quantities.

They follow the book and explain; ``direct`` of each robot is for use.
"""

from robomech_ros.parallel.equations.closure import PlatformEquations, PlatformRoots
from robomech_ros.parallel.equations.delta import DeltaQuadratic, delta_quadratic
from robomech_ros.parallel.equations.loops import platform_equations

__all__ = [
    "DeltaQuadratic",
    "PlatformEquations",
    "PlatformRoots",
    "delta_quadratic",
    "platform_equations",
]
