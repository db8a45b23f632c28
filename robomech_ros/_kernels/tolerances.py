"""All tolerances of the solvers, each with its reason.

Lengths are metres and angles radians unless a comment says otherwise.
"""

# --- Geometry of a chain (Denavit-Hartenberg recovery) ---
# Below this sine two axes count as parallel: the foot of their common normal would lie so far
# away (distance / sine) that rounding spoils more digits than the neglected angle does.
PARALLEL_SINE = 1e-8
# A joint axis must be given with at least this length before it is normalised.
AXIS_LENGTH = 1e-9
# Axes that pass each other by less than this (m) meet: it is rounding for an arm of metre size.
INTERSECTING = 1e-12

# --- Rotations from outside ---
# Deviation of a quaternion's norm from 1 that is taken for rounding: messages written by hand
# carry four digits or more.
QUATERNION_NORM = 1e-3
# Largest entry of |Q^T Q - 1| of a rotation matrix that is taken for rounding: entries with four
# digits after the point are off by 5e-5, which makes up to 1.8e-4.  The last row of a pose, 0 0 0
# 1, may be off by as much.
ROTATION_ERROR = 2e-4

# Below this the columns of a rotation are orthonormal up to rounding, and it is left as it is.
ORTHOGONAL = 2e-15

# --- Magnitudes from outside ---
# Largest length (m) of a robot and of a target: more is a mistake of units, and doubles, 1e-10
# apart there, would no longer hold a solution to 1e-9.
LARGEST_LENGTH = 1e6
# Largest angle (rad) of a seed and of a description, by the same measure; limits of joints beyond
# it (rad or m) are what exporters write for none, as in 1e16.
LARGEST_ANGLE = 1e5
# Largest mass (kg) and moment of inertia (kg m^2) of a body.
LARGEST_INERTIA = 1e12
# Part of the greatest principal moment by which published moments, rounded to three digits, may
# miss what a body can have.
INERTIA_ROUNDING = 2e-3

# A column of a torque regressor, of unit length, that is nearer than this to those before it
# depends on them: rounding leaves 1e-13, and what a motion can show is above 1e-4.
BASE_PARAMETER = 1e-8

# --- Polishing of a solution on the pose ---
# Error (rad, m) at which polishing stops: some ten roundings of a pose of an arm of metre size.
POLISHED = 1e-14
# Least damping added to J^T J: its rounding is some 1e-16, so nothing smaller would protect the
# Cholesky factor at a singular posture, and at a regular one 1e-16 costs no digit of a step.
POLISH_DAMPING = 1e-16

# --- Trajectories ---
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
# Peaks between samples are located to this part of the largest Bernstein coefficient.
PEAK_ACCURACY = 1e-11
# Excess over a bound, as a part of it, that is rounding in a cell of a time-optimal path: its rows
# multiply the squared speeds by up to 1e6, one over the length of the shortest cells.
ROW_SLACK = 1e-10
# Time-optimal motions are planned within the limits less this part, and their pieces in time give
# back the accelerations of the path up to the other part: together less than LIMIT_SLACK.
TIMING_MARGIN = 2e-7
TIMING_ACCURACY = 1e-7
# A derivative of a path that steps by less than this part of its largest value is continuous:
# splines from linear equations keep some ten digits.
PATH_STEP = 1e-9
# A piece of a path in which no joint moves farther (rad, m) stands still.
PATH_STANDSTILL = 1e-12

# --- Paths ---
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

# --- Three parallel axes: recognition ---
# Largest sine between axes taken as parallel: nine printed digits of an angle keep within it, a
# calibrated arm does not.  What is neglected here the polish on the true pose puts back.
PARALLEL_ANGLE = 1e-8
# Largest distance (of the arm's size) between axes 5 and 6 taken as meeting; beyond, the general
# equations are accurate although nearly separate.
PARALLEL_MEETING = 1e-10
# Up to here the same deviations are rounding, and algebraic residuals need no second look.
PARALLEL_EXACT = 1e-14
# Axes of the parallel three nearer to each other than this (of the arm's size), or other axes
# with a smaller sine to them, make an arm that loses a degree of freedom: not this family.
PARALLEL_DISTANCE = 1e-5
# Least ratio of singular values, at the best of some postures, of an arm with six of freedom.
ARM_MOBILITY = 1e-7
# and of an arm of which a list is called complete: with less, solutions are lost in rounding.
CERTAIN_MOBILITY = 1e-6

# --- Three parallel axes: solution ---
# A target beyond a boundary by no more than this (of the arm's size, or a cosine) counts as on
# it at first: where double roots follow each other, the rounding of one is the square root of
# the other's, and its root again.  The polish then decides by the error of the pose.
PARALLEL_SLACK = 1e-6
# Below this (sine, or distance over size) a direction is rounding: the joint is free to turn.
PARALLEL_FREE = 1e-10
# The same at a double root of skew axes 5 and 6, known to the square root of its rounding only.
PARALLEL_FREE_AT_FOLD = 1e-7
# Steps to either side in which a free shoulder is scanned for the nearest angle in reach; narrower
# ranges are found by the minimum between three steps.
CONTINUUM_STEPS = 48
# Steps per length of the arm in which a free slide is scanned where a turn is free as well.
SLIDE_STEPS = 32
# Half the distance (rad) of two roots below which they are flagged as one double root.
NEAR_DOUBLE = 1e-6
# Where double roots of both equations for (q_a, q_5) coincide, four solutions have become one: the
# fourth root of the rounding tells them apart, with room (sum over the components of a pair).
FOURFOLD_APART = 5e-3
# Error of the equations halfway between two that are one, with room for rounding: between two that
# are not it is the square of the distance.
FOURFOLD_ERROR = 1e-13
# How far (sine) from a double root its two solutions are sought, at first and at last.
FOLD_START = 3e-4
FOLD_LEAST_START = 1e-8
# Postures nearer to each other than this (rad) in every joint are one solution.
SAME_POSTURE = 1e-6
# Algebraic residual above which a solution is polished on the pose.
POLISH_ABOVE = 2e-13
# Error (rad, and m over the size) a solution may keep at most.
ACCEPTED = 1e-9
# Error of its two equations (of order one) that a pair (q_a, q_5) may keep: rounding, with room.
PAIR_ERROR = 1e-12
# Ratio of the factors of these equations below which the roots of the polynomial crowd together,
# and starts are taken from the equations as if they separated, too.
NEARLY_SEPARATE = 1e-2
# An extremum of the polynomial for q_a this near to zero (of its largest value) is tried as a
# double root: half the digits, with room; what is none fails the accuracy asked of the pair.
PARALLEL_TOUCHING = 1e-7

# --- Iterative solver ---
# Damping at the start of an attempt, as a part of the squared error that is left: the step then
# goes over from a short one down the gradient to Newton's as the error vanishes.
ATTEMPT_DAMPING = 0.1
# and what it may sink to after successful steps; the factors of its changes are usual ones.
ATTEMPT_LEAST_DAMPING = 1e-4
# Longest change of a joint (rad or m) in one step: beyond a radian linearisation says nothing.
ATTEMPT_STEP = 1.0
# Squared error at which an attempt ends: 1e-13 in rad and in units of half the arm's length ...
CONVERGED = 1e-26
# ... and of a far target, where that unit is long: rounding.
CONVERGED_FAR = 1e-30
# An attempt is given up when six steps have not lowered the squared error by this factor.
STALLED = 0.5
# Steps of an attempt at most; those that succeed need 8 in the middle, 30 at the most.
ATTEMPT_ITERATIONS = 40
# Attempts for one target: nine in ten targets need one or two, the worst of thousands some 100;
# without success they take some 10 ms.
ITERATIVE_RESTARTS = 400
# Attempts without a new solution after which the search ends.
ITERATIVE_PATIENCE = 60
# Where solutions form a continuum: how many to collect, and how far apart (rad or m).
ITERATIVE_WANTED_REDUNDANT = 8
ITERATIVE_APART_REDUNDANT = 0.1
# Isolated solutions nearer to each other than this (rad or m) are one, found at the accuracy
# that a singular posture leaves at the default tolerances.  Of solutions that only hold looser
# ones it goes with their square root, as that accuracy does, up to a value that still tells
# postures apart.
ITERATIVE_APART = 1e-4
ITERATIVE_APART_MOST = 0.5
# Default tolerances of a pose: what an outside check may ask of every solution (m, rad).
POSITION_TOLERANCE = 1e-9
ORIENTATION_TOLERANCE = 1e-9

# --- Real roots ---
# A polynomial's extremum, or a discriminant, this small (relative) is rounding: a double root.
# The two roots it merges lie within its square root of each other.
DOUBLE_ROOT = 1e-14
# Coefficients this small where the largest is of order one are rounding: the equation is void.
VANISHING = 1e-12

# --- Arms with a spherical wrist: recognition (of the arm's size, or a sine) ---
# Wrist axes that pass each other by no more than this are taken as meeting: angles written with
# five digits, as 1.5708, move an axis by some 4e-6.  The polish on the true pose makes up for it.
CONCURRENT = 1e-5
# Up to here the deviation, angles written with eleven digits, is far below ACCEPTED.  Beyond, two
# solutions near a singular posture may be taken for one: a whole arm of six joints is then solved
# as a general one, where it can be.
CONCURRENT_EXACT = 1e-11
# Neighbouring axes of the arm this nearly parallel or meeting are solved as if they were, since
# the general equations lose as many digits; the posture is improved afterwards.
NEARLY_SPECIAL = 1e-5
# Least determinant of the arm's Jacobian (lengths over the size) at the best of some postures,
# and least sine between neighbouring wrist axes, of an arm that moves in all directions.
ARM_RANK = 1e-7
# Axes that miss a common point by less than this (over the size) meet, for the name of a part.
NAMED_MISFIT = 1e-6
# Singular values below this (of the largest) are zero: postures typed to six digits are singular.
RANK = 1e-6
# A named factor of the determinant below this is zero in a posture that is singular.
FACTOR_ZERO = 1e-4
# Least singular value (lengths over the characteristic length) of a posture found to be singular.
ON_SINGULARITY = 1e-8

# --- Arms with a spherical wrist: solution ---
# How far beyond a boundary (relative) a candidate is kept, to be judged by its residual: with an
# exact geometry, and with one that was idealised by up to NEARLY_SPECIAL.
CANDIDATE_SLACK = 1e-9
IDEALISED_SLACK = 1e-4
# A wrist centre this near to a joint axis (of the size) is on it: any angle of that joint keeps it
# in place to better than ACCEPTED.
ON_AXIS = 1e-11
# The same for the sine between axes 4 and 6 of the wrist.
PARALLEL_AXES = 1e-11
# Near a singularity of the arm its joints are uncertain by this over the determinant of its
# Jacobian (relative to REGULAR), and at a double root by the square root of a rounding; so far
# from parallel the axes may then be found.
ARM_ROUNDING = 1e-14
PARALLEL_AT_FOLD = 3e-5

# Below this determinant, relative to REGULAR, a candidate that had to be improved may stand for
# two solutions (an error of IDEALISED_SLACK reaches the square root of it at a double root).
NEAR_SINGULAR = 3e-2
# A second solution beside a fold must be this good (rad, and lengths over the size) ...
SHARP = 1e-12
# ... and this far from the first (rad), some ten times what such an error leaves open.
FOLD_APART = 1e-5

# --- Names of postures ---
# Axes that miss each other by no more than this (of the arm's size), or are no farther from being
# parallel (a sine), leave shoulder, elbow and wrist their names: angles written with four digits,
# as 1.571, are off by 2e-4.
NEARLY_NAMED = 1e-3
# A posture is found again (rad) from its own pose to this, though it be a double root.
SAME_NAMED = 1e-4

# --- Reach ---
# A point this near (m) is reached: below what the message that names the distance shows, above
# what the search attains at a point of the boundary, where its convergence is slow.
REACHED = 1e-7
# Starts and Newton steps of each in the search for the least distance: every local minimum of
# the arms in the tests has a basin found within a dozen starts.
REACH_STARTS = 64
REACH_ITERATIONS = 60
# The same in the search for the least orientation error, and the weight of the position there:
# so large that the position keeps its place to some 1e-6 of the arm's length.
REACH_ATTEMPTS = 40
REACH_ATTEMPT_ITERATIONS = 80
REACH_LAST_ITERATIONS = 1000
REACH_POSITION_WEIGHT = 1e6

# --- Limits and order of solutions ---
# A joint beyond its limit by no more than this (rad or m) is on it: rounding of a posture that was
# put on the limit, and too little to spoil the pose.
AT_LIMIT = 1e-10
# Least singular value of a Jacobian (of its largest) of a posture that is not called singular.
SINGULAR = 1e-12
# Cosine between two rows that counts as zero when singular values are computed.
ROWS_ORTHOGONAL = 1e-15
# Part in the motion of a continuum (a unit vector, rad or m) below which a joint stands still.
MOVES_IN_CONTINUUM = 1e-6
# Windings listed for one pose, at most: eight solutions of six joints with three windings each
# are 5832; a file of limits in thousands of turns must not fill the memory.
MOST_WINDINGS = 8192

# --- General six-joint arms: the determinant (lengths over the size) ---
# Rounding of the determinant, over the product of all pivots but the least: a dozen eliminations
# of entries of order one, which are themselves rounded.
DETERMINANT_NOISE = 1e-14
# Below this the unknowns that a form eliminates are too dependent for it.
GENERAL_MARGIN = 1e-6
# A pivot below this (of the first) is zero: there is nothing left to eliminate.
GENERAL_RANK = 1e-13
# A determinant whose largest value is not this many times its rounding says nothing.
GENERAL_VOID = 1e3
# An interval is sampled anew where no coefficient exceeds its rounding more often than this.
GENERAL_ANEW = 1e4
# Least width of an interval (of half an arc): the square root of the rounding.
GENERAL_WIDTH = 1e-6
# An interval this short is not halved on where all coefficients are within so many roundings: a
# zero of multiplicity eight is not known better; a longer one may be, once sampled anew.
GENERAL_ROUGH_WIDTH = 5e-2
GENERAL_ROUNDING = 4.0
# Complex zeros this near to the real ones (rad) may be those of a singular posture that a nudge
# (its square root, with room) has made complex.
GENERAL_NEAR_ZERO = 0.2
# Halvings and samplings allowed for one determinant: ten times what any pose of the arms tested
# needs that is not singular.
GENERAL_HALVINGS = 600
GENERAL_SAMPLINGS = 16

# Below this (of squares of sines) the axes about which two joints turn line up, for another form to
# be asked.
SLIDES_REGULAR = 1e-8
# Where the discriminant of joint c (absolute) is not below this negative value, the rounding of a
# simple zero may have made it negative.
SLIDES_BRANCH = 1e-6
# Above this discriminant (relative) two postures are more than SAME_POSTURE apart, and its rounding
# leaves them where they are.
SLIDES_DOUBLE = 1e-11
# Over an interval so wide (rad) a square of a sine that is beyond it at both ends is so in between.
SLIDES_WIDTH = 1e-4
# Damping (of squares of sines) of slides that can move against each other: above the rounding.
SLIDES_DAMPING = 1e-13
# Postures with slides farther out than this (of the arm's size) are none: the slides are parallel.
SLIDES_FARTHEST = 1e6

# --- General six-joint arms: singular matrices ---
# So many times the width of a cluster of zeros (rad) the next pivot of the matrix (of the first)
# must be, for all postures of the cluster to be one, or merged ones nearer than can be told.
CLUSTER_GAP = 100.0
# Least of the same where the cluster is narrower than rounding lets a pivot be.
CLUSTER_LEAST_GAP = 1e-6
# Widest cluster (rad) of which that can be told; a fold's is some 1e-5.
CLUSTER_WIDTH = 5e-5
# Below this pivot (of the first) two postures are looked for.
CLUSTER_PENCIL = 5e-2
# Quadratic equations this small on an orthonormal pencil are rounding: all of it are postures.
PENCIL_VOID = 1e-4
# Value of these equations below which a vector may belong to a posture.
PENCIL_IS_PRODUCT = 5e-2

# --- General six-joint arms: postures ---
# Newton steps for a posture from a simple zero.
GENERAL_STEPS = 12
# Error (rad, and lengths over a size beyond a metre) that may remain: far less than ACCEPTED, since
# where m solutions have become one the posture is off by the m-th root of it.
GENERAL_ERROR = 1e-11
# Ratio of pivots of a Jacobian (lengths over the size) below which a posture counts as singular,
# and above which as far from singular.
GENERAL_SINGULAR = 1e-6
GENERAL_REGULAR = 2e-2
# The same ratio of the last pivot below which rounding moves a posture by SAME_POSTURE or more;
# with slides hundreds of sizes out it is some 1e-8.
GENERAL_LOST = 1e-10
# The same ratio of the last pivot but one below which it has lost two ranks.
GENERAL_CORANK = 1e-4
# Along the direction that a singular Jacobian (lengths over the size) takes to zero the pose bends
# away, in the direction that it lacks, by this (per half a square of the step) where two solutions
# have become one and no more: above what rounding leaves of zero, and where solutions have settled,
# for no third one to be near; and the step (rad) over which that is seen.
FOLD_LEAST = 1e-7
FOLD_SHARP = 1e-2
FOLD_STEP = 1e-4
# There the last pivot but one must be this much of what the last one must be elsewhere.
FOLD_RANK = 0.1
# Values of a hidden joint that are tried where its determinant vanishes all round.
GENERAL_FREE_VALUES = 16
# Singular postures nearer to each other than this (rad) are one: the square root of the pose's
# rounding, with room; and up to a higher root of it where there is one halfway, too.
SAME_SINGULAR = 1e-5
SAME_MULTIPLE = 5e-2
# Starts of a search where nothing has been found and nothing is proved.
GENERAL_STARTS = 32
# Solutions that are entered for the continua of one pose: room is left for the others.
MOST_CONTINUA = 6
# A regular solution is not farther (rad) from its nudged one.
NUDGED_AWAY = 0.2
# A nudged posture is followed back in these parts where it does not settle at once.
NUDGE_PARTS = (0.5, 0.25, 0.125, 0.06, 2e-2, 4e-3, 4e-4, 4e-5, 4e-6)

# --- General six-joint arms: settling at singular postures ---
# Steps at most, and how many may pass without the squared error sinking by this factor.
# Twice as many may where it is below a bound; towards a continuum convergence is quadratic.
SETTLING_STEPS = 80
SETTLING_CALM_STEPS = 10
SETTLING_PATIENCE = 12
SETTLING_NEAR = 1e-12
SETTLING_GAIN = 0.25
# Damping over the squared error (towards a continuum: over the error), and what is always there:
# the rounding of a Jacobian, squared.
SETTLING_DAMPING = 1e-2
SETTLING_ROUNDING = 1e-31
# Longest step of a joint (rad).
SETTLING_STEP = 0.3
# Steps are summed up that shrink by a factor between these, 1/2 at a fold, and are parallel but for
# this part (squared).
SETTLING_LEAST_FACTOR = 0.3
SETTLING_MOST_FACTOR = 0.95
SETTLING_ASIDE = 0.04
# Squared error (rad, and lengths over the size) of a pose known to rounding.
SETTLED = 1e-30
# A step (rad) away from a singular posture, the error (as above) that may be left then, and how
# much of the step must be left, to tell a continuum.
CONTINUUM_STEP = 5e-2
CONTINUUM_ERROR = 1e-14
CONTINUUM_KEPT = 3e-2
# The same of one joint alone, where two ranks are lost.
CONTINUUM_FAR_STEP = 0.3
CONTINUUM_FAR_KEPT = 6e-2

# --- Redundant arms ---
# The wrist centre of an arm with a spherical shoulder counts as on the boundary of its reach where
# it is beyond by no more than this (of the square of the size), and as above the shoulder, where
# arm angles have no reference, within this sine.
ON_BOUNDARY = 1e-12
# Three axes of a redundant arm this near (of its size) to a common point are solved as if they met
# there, every solution is polished, and near singular postures the general equations are asked.
NEARLY_SPHERICAL = 2e-3
# So many times what the axes pass each other by, a target may be beyond a boundary of the idealised
# arm and within reach of the true one.
SPHERICAL_SLACK = 10.0
# Values of the redundancy parameter for a list of solutions, with one locked joint and with the
# arm angle: 24 solutions and more for most poses.
LOCKED_SAMPLES = 8
ANGLE_SAMPLES = 8
# and how many times finer they are taken where none gives a solution inside the limits.
FINER_SAMPLES = 4
# Solutions listed for one pose of a redundant arm.
MOST_SAMPLED = 64
# The nearest solution is sought along the self-motion until a step is shorter than this (rad or m):
# the next one would be about its square.
NEAREST_STEP = 1e-3
# So many of the nearest samples are moved along, those within so much (rad or m) of the first:
# about as much as lies between samples.
APPROACHED = 3
APPROACHED_WITHIN = 0.8
# but not one that is this near (rad or m) to a posture that is as near as its self-motion goes: it
# would only lead there.
APPROACHED_AGAIN = 0.03
# Error of the pose (rad, m) at which it is good.
NEAREST_ERROR = 1e-12
# Damping over the squared error, which keeps steps beside a singular posture short and hinders no
# other.
NEAREST_DAMPING = 1e-2
# and steps at most, half of them along the self-motion: those that go well need four to seven.
NEAREST_ITERATIONS = 20

# --- Self-motion ---
# Step of the redundancy parameter (rad or m) at most, and below which a branch that cannot be
# followed has ended.
SELF_MOTION_STEP = 0.05
SELF_MOTION_LEAST = 1e-7
# Postures of neighbouring values belong together where no joint moves farther than this (rad or m)
# and the next nearest pair is so many times farther apart.
SELF_MOTION_NEAR = 0.3
SELF_MOTION_APART = 2.0
# Peaks of a criterion that are refined, and golden sections for each: 1e-7 of a step.
BEST_STARTS = 4
BEST_SECTIONS = 32

# --- Arms of fewer than six joints ---
# Imagined joints this near to zero (rad, or of the size) may be at zero: a polish of the arm itself
# decides.
SHORT_SLACK = 1e-3
# More solutions than this, sought where the completed arm is singular, are a continuum.
SHORT_CONTINUUM = 8
# A completed arm with at least this determinant (lengths over the size) is taken at once.
SHORT_REGULAR = 0.02
# The posture of least squares: starts, steps of each, and the part of the squared error that six
# steps may leave; convergence is linear where the error does not vanish.
LEAST_SQUARES_STARTS = 48
LEAST_SQUARES_ITERATIONS = 300
LEAST_SQUARES_STALL = 1.0 - 1e-9

# --- Paths of poses ---
# Largest move of a joint (rad, m) between two poses that is no jump: paths are sampled finer.
TRACK_JUMP = 0.5
TRACK_JUMP_SLIDE = 0.1
# Values of the redundancy parameter at which a path is looked for, how often the distance to the
# end of a branch is halved, and how often the path is smoothed.
TRACK_PARAMETERS = 64
TRACK_HALVINGS = 6
TRACK_SWEEPS = 8
