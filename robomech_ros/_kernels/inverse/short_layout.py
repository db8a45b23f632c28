"""Layout of the constants of an arm of n < 6 joints in its data array.

The arm is completed to one of six joints by imagined ones, so that it has a closed form; solutions
are those in which the imagined joints stay at zero.
"""

JOINTS = 0  # n
SIX = 1  # family of the six
BACKWARDS = 2  # 1.0 where their inverse motion is solved
EXACT = 3  # 1.0 where nothing is idealised
SIZE = 4  # length of the arm (m)
PLACES = 5  # for each of the six: which joint of the arm it is, -1 for an imagined one
SLIDES = 11  # for each of the six: 1.0 for a prismatic joint
PARTS = 17  # the packed chain, n + 1 rows of 13; then the constants of the six

# Errors (m, rad) that are accepted, since poses are typed and sent with rounded digits: six after
# the point are off by 5e-7, a rotation with as many by some 1e-6.
POSITION_TOLERANCE = 1e-5
ORIENTATION_TOLERANCE = 1e-4
