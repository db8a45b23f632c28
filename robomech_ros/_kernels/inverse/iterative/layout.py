"""Layout of the iterative solver's constants in its data array, for a chain of n joints."""

JOINTS = 0  # n
UNIT = 1  # weight of the squared position error against the squared angle (1/m^2)
POSITION_TOLERANCE = 2  # m
ORIENTATION_TOLERANCE = 3  # rad
ITERATIONS = 4  # largest number of steps of one attempt
RESTARTS = 5  # attempts of one call of solve_iterative
MAX_SOLUTIONS = 6  # largest number of solutions
PATIENCE = 7  # with a solution, attempts in a row without a new one after which the search stops
MIN_DISTANCE = 8  # least distance (rad or m, largest over the joints) of two solutions
STALL = 9  # an attempt ends when six steps leave more than this fraction of the squared error
WEIGHTS = 10  # six of 0 or 1: rotation about x y z, position x y z of the base
FAR_LENGTH = 16  # arm length (m) beyond which a target is far; infinite if every slide has limits
MIN_SHARP_DISTANCE = 17  # least distance of two solutions within the default tolerances
WIDTH = 18  # numbers in a row of the packed chain
ROWS = 19  # start of rows of n numbers: lower, upper, start, width, stride, turns
# lower and upper bound the search; starts lie in [start, start + width], advanced by the
# stride, a fraction of the width; turns is 1 for a joint whose angle may be wrapped.
N_ROWS = 6  # then the packed chain, a row for each joint and one more

# Indices of the numbers that a search passes to its continuation.
IDLE = 0  # attempts since the last new solution
BEST_SCORE = 1  # least error so far, in units of the tolerances
BEST_POSITION = 2  # its position error (m) and orientation error (rad)
BEST_ORIENTATION = 3
BEST_Q = 4  # its n joint values; then for each solution 1 if sharp, 0 if loose
