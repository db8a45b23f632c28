"""Tolerances that several modules of kinematics and those above share, each with its reason.

Lengths are over the size of the arm unless a comment says otherwise.
"""

# Wrist axes that pass each other by no more than this are taken as meeting: angles written with
# five digits, as 1.5708, move an axis by some 4e-6.  The polish on the true pose makes up for it.
CONCURRENT = 1e-5
# Up to here the deviation, angles written with eleven digits, is far below ACCEPTED.  Beyond, two
# solutions near a singular posture may be taken for one: a whole arm of six joints is then solved
# as a general one, where it can be.
CONCURRENT_EXACT = 1e-11
# Least determinant of the arm's Jacobian (lengths over the size) at the best of some postures,
# and least sine between neighbouring wrist axes, of an arm that moves in all directions.
ARM_RANK = 1e-7

# Axes that miss each other by no more than this (of the arm's size), or are no farther from being
# parallel (a sine), leave shoulder, elbow and wrist their names: angles written with four digits,
# as 1.571, are off by 2e-4.
NEARLY_NAMED = 1e-3

# Solutions listed for one pose of a redundant arm.
MOST_SAMPLED = 64
