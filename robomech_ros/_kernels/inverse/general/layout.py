"""Layout of the constants of a general six-joint arm in its data array.

A form is one way to the solutions.  With one slide at most it is an elimination.  It walks round
the closed loop of the six joints and of the target pose in one sense, from one of its links, and
so fixes the parts that the joints play: FIRST and SECOND are eliminated linearly, HIDDEN is the
unknown of the determinant, THIRD and FOURTH are eliminated with it, LAST turns about an axis that
no equation sees.  A slide plays FIRST, THIRD or FOURTH.

With two or three slides (see ``slides``) a form is a revolute joint to begin the loop at.
"""

FIRST = 0
SECOND = 1
HIDDEN = 2
THIRD = 3
FOURTH = 4
LAST = 5

FORMS = 0  # how many forms follow, the best first
SIZE = 1  # length of the arm (m), the unit of all lengths below
CLEAN = 2  # part of some random poses that the first form alone solves with nothing in doubt
SLIDES = 3  # number of prismatic joints
BASE = 4  # 3x4: inverse of C_0; its origin over the size
TIP = 16  # 3x4: inverse of C_6, likewise
PACKED = 28  # the packed chain, 7 rows of 13
HEAD = PACKED + 7 * 13

# Within each form of an arm with one slide at most, links in the order of the walk:
TARGET = 0  # which link carries the target: 0 the one behind joint FIRST, 5 the one before it
SENSE = 1  # 1.0 in the sense of the chain, -1.0 against it
JOINTS = 2  # six joint numbers: FIRST .. LAST
OFFSETS = 8  # what is added to the angles of THIRD and FOURTH, so that 0 and pi are no round values
SLIDE = 10  # which part the slide plays, -1.0 where there is none
BEFORE = 11  # 3x4: inverse of the link before FIRST
BEHIND = 23  # 3x4: inverse of the link behind it
LINKS = 35  # four times 3x4: the links behind SECOND, HIDDEN, THIRD and FOURTH
EQUATIONS = 83  # 14 x 3 x 9: cosine, sine and constant part in HIDDEN, monomials of the next two
# Entries that depend on the target stay open until it is known: EQUATIONS, too, unless next to
# joint FIRST.
N_EQUATIONS = 14
N_COLUMNS = 27
FORM = EQUATIONS + N_EQUATIONS * N_COLUMNS

# Within each form of an arm with two or three slides, with JOINTS in the order of the loop:
TARGET_LINK = 0  # which of the links carries the target
KINDS = 8  # of the six joints: 1.0 for a slide
LOOP = 14  # six times 3x4: the links behind the joints, the target's not used

MOST_FORMS = 4  # kept of an arm
