"""Layout of the constants of a decoupled arm in its data array.

The wrist centre has the constant coordinates W in the frame that moves with joint 3, so that the
arm's part of the problem is ``J_1 C_1 J_2 C_2 J_3 W = c``.  From the tip it reads
``J_3' C_2^-1 J_2' C_1^-1 J_1' c = W`` with J' the inverse motions: the same problem, solved in the
simpler direction.  FIRST and SECOND are C_1 and C_2 in the direction of solution.  Lengths of the
arm's part are in units of SIZE.
"""

# Solvers of the arm's part, by the joints in the direction of solution.
REVOLUTE_SPLIT = 0  # RRR, first two axes parallel or intersecting: two quadratics
REVOLUTE_QUARTIC = 1  # RRR, any: one quartic
SLIDE_TURN_TURN = 2  # PRR
TURN_SLIDE_TURN = 3  # RPR
TURN_SLIDE_SLIDE = 4  # RPP
SLIDE_TURN_SLIDE = 5  # PRP
SLIDES = 6  # PPP

KIND = 0
FROM_TIP = 1  # 1.0 if solved from the tip
SIZE = 2  # length of the arm (m)
EXACT = 3  # 1.0 if the wrist axes intersect up to rounding, so that no pose needs Newton steps
SLACK = 4  # largest distance of candidates of the arm beyond a boundary (relative)
NAMED = 5  # side of the arm, +1 or -1, if "shoulder" and "elbow" are defined, else 0
REGULAR = 6  # largest determinant of the arm's Jacobian, lengths in units of SIZE
TYPES = 7  # types of joints 1 to 3: 0 revolute, 1 prismatic
BASE = 10  # 3x4: C_0
C1 = 22  # 3x4
C2 = 34  # 3x4
C3 = 46  # 3x4
WRIST = 58  # W
FIRST = 61  # 3x4
SECOND = 73  # 3x4
# RRR: see arm_revolute.  PRR and RPR: 1.0 if the slide is perpendicular to the first rotation.
EQUATIONS = 85  # e_M, e_N, g_M, g_N, g_x, g_y, eta
SLIDE_INVERSE = 92  # 3x3: inverse of the directions of the slides of PPP
TIP = 101  # 3x3: rotation of C_6, transposed
CENTRE = 110  # wrist centre in the tip frame (m)
ANGLES = 113  # constant angles added to q_4, q_5, q_6
COS4 = 116  # angles between axes 4 and 5 and between axes 5 and 6, both in (0, pi)
SIN4 = 117
COS5 = 118
SIN5 = 119
NEAREST = 120  # least and greatest angle between axes 4 and 6
FARTHEST = 121
UNFLIPPED = 122  # sign of sin(q_5 + angle) of wrist-noflip postures
PACKED = 123  # the packed chain, 7 rows of 13
# 1.0 if another solver solves every pose in doubt, so that this one returns at once.
HAS_FALLBACK = PACKED + 7 * 13
LENGTH = HAS_FALLBACK + 1
