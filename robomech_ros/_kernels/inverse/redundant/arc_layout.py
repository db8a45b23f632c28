"""Where the numbers stand that :mod:`.arcs` and :mod:`.arc_shoulder` write of a self-motion."""

# What is known of an arc in an interval: there is none; there is one with bounded rates; or only
# how far joints go is known.
UNKNOWN = -1
EMPTY = 0
REGULAR = 1
IRREGULAR = 2

# Constants of one pose: the shoulder behind joint 7, the rotation from the base to there.
SHOULDER = 0
TURNED = 3
SQUARE = 12  # of the length of v: constant, cosine and sine parts
RADIUS = 15  # of the circle of the shoulder about axis 7
POSE = 16

# At one t: v, dv/dt, the squared length and its half rate, length across axis 6 and its angle.
V = 0
DV = 3
LENGTH2 = 6
RATE2 = 7
ACROSS = 8
ANGLE = 9
DV_ACROSS = 10
DV_CHANGE = 11  # how far v moves at most
COSINE = 12  # of t
SINE = 13
BEND = 14  # angle of joint 4 from its middle, and how far that goes
BEND_REACH = 15
FAR_OFF = 16  # by how much the distance is out of reach of joint 4, its rate and bow
FAR_OFF_RATE = 17
FAR_OFF_BOW = 18
LEVEL = 19

# Along an arc: the joints, their rates, by how much rates change, and how far joints go.
Q = 0
RATE = 7
SPREAD = 14
REACH = 21
COSINES = 28  # of joints 4 to 7
SINES = 32
TURN = 36  # angular velocity of the upper arm in the base
TURN_CHANGE = 39  # by how much that changes, or where it has no bound, by how much the arm turns
AXES = 40  # 3 to 7 in the base
BENT = 55  # second derivatives of the joints, and by how much those change
UNBENT = 62
ARC = 69

# With one bend of the elbow: u, its change with joint 4, the cosine that gives joint 6 and how far
# that goes, how far the point moves across axis 6 and how near to that it comes.
U = 0
DU = 3
COSINE_6 = 6
COSINE_6_REACH = 7
MOVED = 8
NEAREST = 9
RATE_6 = 10  # of that cosine, or 0.0 where it is not known
RATE_4 = 11  # of joint 4, by how much it changes, which is negative where it has no bound
SPREAD_4 = 12
# By how much the component along axis 5 is too long for a joint 6, which there is where that is
# 0 or less, its rate, and the most by which it is less than these tell, over the squared time.
BEYOND = 13
BEYOND_RATE = 14
BEYOND_BOW = 15
FOLD = 16

# How far a joint goes that may be anywhere (rad).
FAR = 1e3
