"""Tolerances of paths, each with its reason."""

__all__ = [
    "ARC_LENGTH",
    "ARC_LENGTH_HALVINGS",
    "AT_REST",
    "AT_START",
    "CLOSED",
    "COINCIDENT",
    "COLLINEAR",
    "CORRECTED",
    "CORRECTIONS",
    "INVERSE_STEPS",
    "LEAST_TOLERANCE",
    "MOST_STEPS",
    "NEARLY_HALF_TURN",
    "ON_PATH",
    "PARAMETER_SLACK",
    "RATE_STEP",
    "SHORTEST_STEP",
    "SPLINE_STEPS",
    "STRAIGHT",
    "TURN_STEP",
    "VANISHING_SPEED",
]

# A parameter beyond the end of a curve by this part of its range is on the end: rounding of sums.
PARAMETER_SLACK = 1e-9
# Points nearer to each other than this part of the size of their set are one point.
COINCIDENT = 1e-9
# Sine of the angle at one of three points below which they lie on a line: the radius through them
# would be a hundred million times their distance.
COLLINEAR = 1e-8
# Joint values (rad, m) that differ by less where a path closes are the same: what correcting each
# leaves open near a singularity.
CLOSED = 1e-6
# Curvature times length below which a curve is straight there: nine digits of its second
# derivative are gone, and no normal is left in the others.
STRAIGHT = 1e-9
# Speed, as part of the largest one, below which a curve has no direction: a cusp.
VANISHING_SPEED = 1e-6
# An interval is halved until the last coefficients of the speed in it, times the interval, are
# below this part of the whole length: above the rounding of a sum of sixteen terms.
ARC_LENGTH = 3e-14
# Halvings of an interval at most: a billionth of a billionth of it is below rounding.
ARC_LENGTH_HALVINGS = 50
# Newton steps for the parameter at an arc length; they double the digits each time.
INVERSE_STEPS = 12
# Two orientations this near (rad) to opposite have no axis that is certain: the angle of matrices
# written with six digits is no better known.
NEARLY_HALF_TURN = 1e-6
# Newton steps for a rotation spline; convergence is quadratic.
SPLINE_STEPS = 50
# Step of a twist, over a unit of the path and turned into lengths by the path's own, that is no
# rounding: second derivatives of blends of a millimetre keep eight digits.
RATE_STEP = 1e-7
# Turn (rad) of a moving frame within the least interval looked at that is a jump.
TURN_STEP = 1e-3
# Change of joint values (rad, m, relative beyond 1) by a Newton step that ends the correction of a
# posture: convergence is quadratic, the next one would be rounding.
CORRECTED = 1e-11
# Error (rad, and m, relative beyond 1) a corrected pose may have: rounding of the kinematics of an
# arm, with room.
ON_PATH = 1e-9
# Newton steps for a posture from a predicted one; those that go well need two or three.
CORRECTIONS = 10
# Deviation (rad, m) of the given joint values from the start of a path that a correction may take
# away; from farther off inverse kinematics is asked.
AT_START = 1e-3
# Least tolerance (rad, m) of a joint path between its postures: rounding, with room.
LEAST_TOLERANCE = 1e-10
# Least step along a path, as part of the distance of two breaks: a path that needs shorter ones is
# singular there.
SHORTEST_STEP = 1e-7
# Steps between two breaks at most; with the least tolerance a loop of a metre takes a few hundred.
MOST_STEPS = 10_000
# Speed of a time law, over its mean, that is rest where the path has a corner.
AT_REST = 1e-6
