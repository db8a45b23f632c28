"""Tolerances shared by kernel modules, or by kernels and their callers.

Lengths are metres and angles radians unless a comment says otherwise.  Tolerances of one module
are defined in it.
"""

# --- Rotations from outside: spatial checks and corrects them as the kernels do ---
# Largest entry of |Q^T Q - 1| that counts as rounding of a rotation matrix: entries with four
# decimals are off by 5e-5, which makes up to 1.8e-4.  The last row of a pose, 0 0 0 1, may be off
# by as much.
ROTATION_ERROR = 2e-4
# Below this error a rotation is orthonormal to working precision and stays unchanged.
ORTHOGONAL = 2e-15

# --- Magnitudes from outside: robots, trajectories, nodes and dynamics reject larger ones ---
# Largest length (m) of a robot or target: a larger one is a mistake of units, and doubles, 1e-10
# apart there, could not represent a solution to 1e-9.
LARGEST_LENGTH = 1e6
# Joint rate (rad/s or m/s) above which a simulated motion diverges: far above that of any robot,
# and products of such rates are far from overflow.
LARGEST_SERVO_RATE = 1e6

# --- Solutions ---
# Two roots whose half distance (rad) is below this are flagged as one double root.
NEAR_DOUBLE = 1e-6
# Postures that differ by less than this (rad) in every joint are one solution.
SAME_POSTURE = 1e-6
# Algebraic residual above which a solution is polished on the pose.
POLISH_ABOVE = 2e-13
# Largest error of a solution (rad, and m over the size).
ACCEPTED = 1e-9
# Default tolerances of a pose (m, rad), for a check of solutions by the caller.
POSITION_TOLERANCE = 1e-9
ORIENTATION_TOLERANCE = 1e-9

# --- Singular postures ---
# Singular values below this (of the largest) are zero: postures typed to six digits are singular.
RANK = 1e-6

# --- Arms with a spherical wrist ---
# Relative distance beyond a boundary up to which a candidate is tested by its residual, if the
# geometry was idealised.
IDEALISED_SLACK = 1e-4
# A wrist centre this near to a joint axis (of the size) is on it: rotations of that joint move the
# centre by less than ACCEPTED.
ON_AXIS = 1e-11
# The same for the sine between axes 4 and 6 of the wrist.
PARALLEL_AXES = 1e-11

# --- Limits ---
# A joint beyond its limit by at most this (rad or m) is at the limit: it is rounding, too little
# to affect the pose.
AT_LIMIT = 1e-10

# --- General six-joint arms ---
# Largest ratio of last to first pivot of the Jacobian (lengths over the size) in singular postures.
GENERAL_SINGULAR = 1e-6
# The same ratio of the last but one pivot, below which the rank is at most four.
GENERAL_CORANK = 1e-4
# Step (rad) from a singular posture.  If the pose can be kept there, the posture is one of
# infinitely many for it.
CONTINUUM_STEP = 5e-2

# --- Redundant arms ---
# The wrist centre of an arm with a spherical shoulder is on the boundary of its reach if it is
# beyond by at most this (of the squared size), and above the shoulder, where arm angles have no
# reference, within this sine.
ON_BOUNDARY = 1e-12
