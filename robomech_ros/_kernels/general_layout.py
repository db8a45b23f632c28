"""Where the constants of a general six-joint arm stand in its data array.

A form is one way to eliminate.  It walks round the closed loop of the six joints and of the
target pose in one sense, from one of two starts, and so fixes the parts that the joints play:
FIRST and SECOND are eliminated linearly, HIDDEN is the unknown of the determinant, THIRD and
FOURTH are eliminated with it, LAST turns about an axis that no equation sees.
"""

FIRST = 0
SECOND = 1
HIDDEN = 2
THIRD = 3
FOURTH = 4
LAST = 5

# Which link of the loop carries the target: the one before joint FIRST, or the one behind it.
TARGET_BEFORE = 0
TARGET_BEHIND = 1

FORMS = 0  # how many forms follow, the best first
SIZE = 1  # length of the arm (m), the unit of all lengths below
CLEAN = 2  # part of some random poses that the first form alone solves with nothing in doubt
BASE = 3  # 3x4: inverse of C_0; its origin over the size
TIP = 15  # 3x4: inverse of C_6, likewise
PACKED = 27  # the packed chain, 7 rows of 13
HEAD = PACKED + 7 * 13

# Within each form:
TARGET = 0  # TARGET_BEFORE or TARGET_BEHIND
SENSE = 1  # 1.0 in the sense of the chain, -1.0 against it
JOINTS = 2  # six joint numbers: FIRST .. LAST
OFFSETS = 8  # what is added to the angles of THIRD and FOURTH, so that 0 and pi are no round values
FIXED = 10  # 3x4: inverse of the constant one of the two links next to FIRST
LINKS = 22  # four times 3x4: the links behind SECOND, HIDDEN, THIRD and FOURTH
EQUATIONS = 70  # 14 x 3 x 9: cosine, sine and constant part in HIDDEN, monomials of the next two
N_EQUATIONS = 14
N_COLUMNS = 27
FORM = EQUATIONS + N_EQUATIONS * N_COLUMNS
MOST_FORMS = 4
