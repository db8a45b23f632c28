"""Tolerances that several modules of trajectories share, each with its reason.

Lengths are metres, angles radians and times seconds.
"""

# No trajectory lasts less (s): its times stay distinct in whole nanoseconds, and derivatives
# computed from its samples keep about eight digits.
SHORTEST_TRAJECTORY = 1e-3
# A duration shorter than the shortest possible by no more than this (s, and relative) is the
# shortest itself, rounded to the nanoseconds of a message.
DURATION_ROUNDING = 1e-9
# A start or goal this far (rad, m) outside the position limits still counts as on the limit:
# encoders and text files carry about this resolution.
POSITION_SLACK = 1e-6
# Relative excess over a velocity, acceleration or jerk limit that counts as rounding.
LIMIT_SLACK = 1e-6
# A derivative of a path that steps by less than this part of its largest value is continuous:
# splines from linear equations keep some ten digits.
PATH_STEP = 1e-9
# A piece of a path in which no joint moves farther (rad, m) stands still.
PATH_STANDSTILL = 1e-12

# A parameter beyond the end of a curve by this part of its range is on the end: rounding of sums.
PARAMETER_SLACK = 1e-9
# Points nearer to each other than this part of the size of their set are one point.
COINCIDENT = 1e-9
# Sine of the angle at one of three points below which they lie on a line: the radius through them
# would be a hundred million times their distance.
COLLINEAR = 1e-8
# Two orientations this near (rad) to opposite have no axis that is certain: the angle of matrices
# written with six digits is no better known.
NEARLY_HALF_TURN = 1e-6
