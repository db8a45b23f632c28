"""Layout of the constants of a redundant arm of n joints in its data array.

LOCKED arms have six consecutive joints, from FIRST on, with a closed form; the n - 6 others are
locked at chosen values.  ARM_ANGLE arms have seven revolute joints, axes 1 to 3 through one point
and axes 5 to 7 through another; the angle of the elbow about the line between both is chosen.
"""

LOCKED = 0
ARM_ANGLE = 1

KIND = 0
JOINTS = 1  # n
FIRST = 2  # first joint of the six
BACKWARDS = 3  # 1.0 if their inverse motion is solved
SIX = 4  # family of the six joints
# Start of their constants as a general arm, used if their own family is in doubt; 0.0 if never
GENERAL = 5
SAMPLES = 6  # number of values of the redundancy parameter
SIZE = 7  # length of the arm (m)
# Start of the ARM_ANGLE layout of a LOCKED arm with two nearly spherical joints; 0.0 for others
ANGLE = 8
# For a LOCKED arm whose locked joint moves shoulder and wrist together: the centre outside the six
# joints, in the base or, if joint 1 is locked, in the tip frame (m); the direction of the other
# centre in the frame of the locked joint; and 1.0 if they are known.
CENTRE = 9
TOWARDS = 12
STRETCHED = 14
SLACK = 15  # for ARM_ANGLE, largest distance of the wrist beyond its reach (of the squared size)
# The packed chain, n + 1 rows of 13; then for LOCKED the constants of the family of the six joints,
# for ARM_ANGLE those of the arm from ARM on, with the offsets below.
PARTS = 16
ARM = PARTS + 8 * 13
CENTRE_0 = 0  # centre of the shoulder in the base (m)
CENTRE_3 = 3  # and in the frame that moves with joint 3
CENTRE_4 = 6  # centre of the wrist in the frame that moves with joint 4
CENTRE_7 = 9  # and in the tip frame
ELBOW = 12  # point of axis 4 nearest to the shoulder, in the frame that moves with joint 3
REFERENCE = 15  # direction in the base that arm angles are measured from
OTHER = 18  # its substitute if the wrist centre is in that direction
# Constants of the shoulder in the order of a wrist in decoupled/layout, from ANGLES on.  SHOULDER
# is so large that an array of that layout with ANGLES here starts inside this array.
SHOULDER = 21
WRIST = 31  # the same of the wrist
LENGTH = 41
