"""Layout of the constants of a general six-joint arm in its data array.

A form is one method of solution.  With at most one slide it is an elimination.  It traverses the
closed loop of the six joints and the target pose in one sense, from one of its links, and so
assigns roles to the joints: FIRST and SECOND are eliminated linearly, HIDDEN is the unknown of the
determinant, THIRD and FOURTH are eliminated with it, and no equation depends on LAST.  A slide is
FIRST, THIRD or FOURTH.

With two or three slides (see ``slides``) a form is the revolute joint at which the loop starts.
"""

FIRST = 0
SECOND = 1
HIDDEN = 2
THIRD = 3
FOURTH = 4
LAST = 5

FORMS = 0  # number of forms, the best first
SIZE = 1  # length of the arm (m), the unit of all lengths below
CLEAN = 2  # fraction of random poses that the first form alone solves without doubt
SLIDES = 3  # number of prismatic joints
BASE = 4  # 3x4: inverse of C_0; its origin over the size
TIP = 16  # 3x4: inverse of C_6, likewise
PACKED = 28  # the packed chain, 7 rows of 13
HEAD = PACKED + 7 * 13

# Within each form of an arm with at most one slide, links in the order of the loop:
TARGET = 0  # index of the link with the target: 0 behind joint FIRST, 5 before it
SENSE = 1  # 1.0 in the sense of the chain, -1.0 against it
JOINTS = 2  # six joint indices: FIRST .. LAST
OFFSETS = 8  # added to the angles of THIRD and FOURTH, so that common postures are not at 0 or pi
SLIDE = 10  # role of the slide, -1.0 without one
BEFORE = 11  # 3x4: inverse of the link before FIRST
BEHIND = 23  # 3x4: inverse of the link behind FIRST
LINKS = 35  # four times 3x4: the links behind SECOND, HIDDEN, THIRD and FOURTH
EQUATIONS = 83  # 14 x 3 x 9: cosine, sine and constant part in HIDDEN, monomials of the next two
# Entries that depend on the target are completed for each pose; EQUATIONS too, unless the target is
# next to joint FIRST.
N_EQUATIONS = 14
N_COLUMNS = 27
FORM = EQUATIONS + N_EQUATIONS * N_COLUMNS

# Within each form of an arm with two or three slides, with JOINTS in the order of the loop:
TARGET_LINK = 0  # index of the link with the target
KINDS = 8  # for each of the six joints: 1.0 for a slide
LOOP = 14  # six times 3x4: the links behind the joints; that of the target is not used

MAX_FORMS = 4  # largest number of forms of an arm
