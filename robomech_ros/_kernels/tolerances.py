"""Tolerances that several kernel modules share, or kernels and the modules that they serve.

Each has its reason. Lengths are metres and angles radians unless a comment says otherwise. What
one file uses stands there.
"""

# --- Rotations from outside: spatial checks and rounds them as the kernels do ---
# Largest entry of |Q^T Q - 1| of a rotation matrix that is taken for rounding: entries with four
# digits after the point are off by 5e-5, which makes up to 1.8e-4.  The last row of a pose, 0 0 0
# 1, may be off by as much.
ROTATION_ERROR = 2e-4
# Below this the columns of a rotation are orthonormal up to rounding, and it is left as it is.
ORTHOGONAL = 2e-15

# --- Magnitudes from outside: robots, trajectories, nodes and dynamics refuse larger ones ---
# Largest length (m) of a robot and of a target: more is a mistake of units, and doubles, 1e-10
# apart there, would no longer hold a solution to 1e-9.
LARGEST_LENGTH = 1e6
# Joint rate (rad/s or m/s) above which a controlled motion has run away: no robot comes near, and
# products of such rates are still far from overflow.
LARGEST_SERVO_RATE = 1e6

# --- Solutions ---
# Half the distance (rad) of two roots below which they are flagged as one double root.
NEAR_DOUBLE = 1e-6
# Postures nearer to each other than this (rad) in every joint are one solution.
SAME_POSTURE = 1e-6
# Algebraic residual above which a solution is polished on the pose.
POLISH_ABOVE = 2e-13
# Error (rad, and m over the size) a solution may keep at most.
ACCEPTED = 1e-9
# Default tolerances of a pose: what an outside check may ask of every solution (m, rad).
POSITION_TOLERANCE = 1e-9
ORIENTATION_TOLERANCE = 1e-9

# --- Singular postures ---
# Singular values below this (of the largest) are zero: postures typed to six digits are singular.
RANK = 1e-6

# --- Arms with a spherical wrist ---
# How far beyond a boundary (relative) a candidate is kept, to be judged by its residual, where the
# geometry was idealised.
IDEALISED_SLACK = 1e-4
# A wrist centre this near to a joint axis (of the size) is on it: any angle of that joint keeps it
# in place to better than ACCEPTED.
ON_AXIS = 1e-11
# The same for the sine between axes 4 and 6 of the wrist.
PARALLEL_AXES = 1e-11

# --- Limits ---
# A joint beyond its limit by no more than this (rad or m) is on it: rounding of a posture that was
# put on the limit, and too little to spoil the pose.
AT_LIMIT = 1e-10

# --- General six-joint arms ---
# Ratio of pivots of a Jacobian (lengths over the size) below which a posture counts as singular.
GENERAL_SINGULAR = 1e-6
# The same ratio of the last pivot but one below which it has lost two ranks.
GENERAL_CORANK = 1e-4
# A step (rad) away from a singular posture: if the arm can stay there, the posture is one of
# infinitely many for the pose.
CONTINUUM_STEP = 5e-2

# --- Redundant arms ---
# The wrist centre of an arm with a spherical shoulder counts as on the boundary of its reach where
# it is beyond by no more than this (of the square of the size), and as above the shoulder, where
# arm angles have no reference, within this sine.
ON_BOUNDARY = 1e-12
