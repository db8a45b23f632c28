"""Layout of the constants of an arm of n < 6 joints in its data array.

The arm is completed to six joints by virtual joints, so that it has a closed form; the virtual
joints of its solutions are zero.
"""

JOINTS = 0  # n
SIX = 1  # family of the completed arm
BACKWARDS = 2  # 1.0 if its inverse motion is solved
EXACT = 3  # 1.0 if nothing is idealised
SIZE = 4  # length of the arm (m)
ARM_JOINTS = 5  # for each of the six joints: its index in the arm, -1 for a virtual joint
SLIDES = 11  # for each of the six joints: 1.0 for a prismatic joint
PARTS = 17  # the packed chain, n + 1 rows of 13; then the constants of the six

# Accepted errors (m, rad), since poses are typed and sent with rounded digits: six decimals are off
# by 5e-7, a rotation with six decimals by about 1e-6.
POSITION_TOLERANCE = 1e-5
ORIENTATION_TOLERANCE = 1e-4
