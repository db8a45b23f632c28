"""Layout of the constants of an arm with three parallel axes in its data array.

Frames: F has its z along the three parallel axes, its origin on the first of them and its x
towards the second.  Frames 5 and 6 are at the feet of the common normal of the last two axes,
z along the axis; y of frame 5 and x of frame 6 lie along that normal.  Frame a belongs to the
remaining axis, with z of F in its xz plane.
"""

# Order of the axes from the base: a | three parallel | 5 6, or three parallel | a 5 6.
# An arm with this layout from the tip is solved as its inverse motion.
AXIS_BEFORE = 0
AXIS_BETWEEN = 1
# Relation of axes 5 and 6; unless they are skew, the two equations for (q_a, q_5) separate.
SKEW = 0
INTERSECTING = 1
PARALLEL = 2

# Prismatic joint among axes a, 5 and 6.
SLIDE_NONE = 0
SLIDE_A = 1
SLIDE_5 = 2
SLIDE_6 = 3

ORDER = 0  # AXIS_BEFORE or AXIS_BETWEEN
FROM_TIP = 1  # 1.0 if the inverse motion is solved
KIND = 2  # SKEW, INTERSECTING or PARALLEL
EXACT = 3  # 1.0 if the geometry was not idealised, so that algebraic residuals can be trusted
SIZE = 4  # length of the arm (m), the unit of the height equation
JOINTS = 5  # six indices of joints: a, the three parallel ones, 5, 6
SENSES = 11  # three signs of the parallel axes along z of F
LINK_1 = 14  # distance of the first two parallel axes (m)
LINK_2 = 15  # distance of the last two (m)
BEND = 16  # angle from the first link to the second at q = 0 (rad)
SIN_A = 17  # x of z_F in frame a
COS_A = 18  # z of z_F in frame a
COS_56 = 19  # cosine and sine of the angle from axis 5 to axis 6, and their distance (m)
SIN_56 = 20
NORMAL_56 = 21
GAMMA = 22  # component of z_F along axis 5: constant, factor of cos q_a, of sin q_a
FIRST = 25  # the same for its component along x of frame 5
SECOND = 28  # and along y of frame 5
HEIGHT = 31  # the same three numbers for the constant part of the height equation (m)
DEFECT_SAME = 34  # 1 - cos(A - B) and 1 + cos(A + B), with A the angle of axes 5 and 6 and
DEFECT_MIRROR = 35  # B that of axis 5 and z_F: both 0 if axis 6 can become parallel to z_F
POINT = 36  # point of the third parallel axis in frame 5 or a (m), at height 0 of F
HEADING = 39  # x of F in the same frame
MIDDLE = 42  # 3x4: frame a in F (axis before), or frame a in frame 5 (axis between)
LEFT = 54  # 3x4 and 3x4: the pose of frame 6 is LEFT T RIGHT, in frame a or F
RIGHT = 66
SLIDING = 78  # SLIDE_NONE and so on
NAMED = 79  # 1.0 for arms whose solutions differ by shoulder, elbow and wrist
SLACK = 80  # largest distance beyond a boundary (cosine, or of the size) of a target that is tried
ROOT_SPLIT = 81  # largest distance (rad) of roots merged by idealising; 0.0 without idealising
PACKED = 82  # the packed chain, 7 rows of 13
LENGTH = PACKED + 7 * 13
