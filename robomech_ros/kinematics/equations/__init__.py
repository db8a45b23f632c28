"""The equations of chapters 4 and 9 of the book as plain functions that return its quantities.

They follow the book and explain; `inverse_kinematics` is for use.
"""

from robomech_ros.kinematics.equations.closure import ClosureEquations, closure_equations
from robomech_ros.kinematics.equations.half_angles import half_angle_polynomial
from robomech_ros.kinematics.equations.li_woernle_hiller import (
    half_angle_equations,
    li_woernle_hiller_matrix,
)
from robomech_ros.kinematics.equations.orientation import (
    OrientationEquation,
    decoupled_postures,
    orientation_equation,
    wrist_angles,
)
from robomech_ros.kinematics.equations.positioning import (
    PositioningEquations,
    arm_angles,
    positioning_equations,
    wrist_centre,
)
from robomech_ros.kinematics.equations.postures import posture_of, remaining_angles
from robomech_ros.kinematics.equations.raghavan_roth import raghavan_roth_matrix
from robomech_ros.kinematics.equations.univariate import (
    PROCEDURES,
    UnivariateRoots,
    li_woernle_hiller,
    raghavan_roth,
)

__all__ = [
    "PROCEDURES",
    "ClosureEquations",
    "OrientationEquation",
    "PositioningEquations",
    "UnivariateRoots",
    "arm_angles",
    "closure_equations",
    "decoupled_postures",
    "half_angle_equations",
    "half_angle_polynomial",
    "li_woernle_hiller",
    "li_woernle_hiller_matrix",
    "orientation_equation",
    "positioning_equations",
    "posture_of",
    "raghavan_roth",
    "raghavan_roth_matrix",
    "remaining_angles",
    "wrist_angles",
    "wrist_centre",
]
