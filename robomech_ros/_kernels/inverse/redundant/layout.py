"""Layout of the constants of a redundant arm of n joints in its data array.

LOCKED arms have six neighbouring joints, from FIRST on, that make an arm with a closed form; the
n - 6 others are locked at chosen values.  ARM_ANGLE arms have seven revolute joints, axes 1 to 3
through one point and axes 5 to 7 through another; the angle of the elbow about the line between
both is chosen.
"""

LOCKED = 0
ARM_ANGLE = 1

KIND = 0
JOINTS = 1  # n
FIRST = 2  # first joint of the six
BACKWARDS = 3  # 1.0 where their inverse motion is solved
SIX = 4  # family of the six
GENERAL = 5  # where their constants as a general arm stand, asked where their own family is in
# doubt; 0.0 where it never is
SAMPLES = 6  # values of the redundancy parameter that are tried
SIZE = 7  # length of the arm (m)
ANGLE = (
    8  # where a LOCKED arm whose axes nearly meet in two points is laid out as an ARM_ANGLE one;
)
# 0.0 where it is no such arm
# For a LOCKED arm whose locked joint moves shoulder and wrist together: the centre beyond
# the six joints, in the base or, where joint 1 is locked, in the tip frame (m); the direction of
# the other one in the frame of the locked joint; and 1.0 where they are known.
CENTRE = 9
TOWARDS = 12
STRETCHED = 14
SLACK = 15  # of ARM_ANGLE arms: how far beyond its reach (of the squared size) the wrist may be
PARTS = 16  # from here the packed chain, n + 1 rows of 13; then, for LOCKED, the constants of the
# six as their family reads them, for ARM_ANGLE from here those of the arm:
ARM = PARTS + 8 * 13
CENTRE_0 = 0  # centre of the shoulder in the base (m)
CENTRE_3 = 3  # and in the frame that moves with joint 3
CENTRE_4 = 6  # centre of the wrist in the frame that moves with joint 4
CENTRE_7 = 9  # and in the tip frame
ELBOW = 12  # point of axis 4 nearest to the shoulder, in the frame that moves with joint 3
REFERENCE = 15  # direction in the base that arm angles are measured from
OTHER = 18  # the one that takes its place where the wrist centre is in that direction
# Constants of the shoulder where decoupled_layout has those of a wrist, ANGLES first: so far from
# the beginning that an array of that layout, of which nothing else is read, begins inside this one.
SHOULDER = 21
WRIST = 31  # the same of the wrist
LENGTH = 41
