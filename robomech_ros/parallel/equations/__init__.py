"""The equations of section 10.2 of the book as plain functions that return its quantities.

They follow the book and explain; ``direct`` of each robot is for use.
"""

from robomech_ros.parallel.equations.delta import DeltaQuadratic, delta_quadratic
from robomech_ros.parallel.equations.loops import platform_equations
from robomech_ros.parallel.equations.platform_equations import PlatformEquations, PlatformRoots

__all__ = [
    "DeltaQuadratic",
    "PlatformEquations",
    "PlatformRoots",
    "delta_quadratic",
    "platform_equations",
]
