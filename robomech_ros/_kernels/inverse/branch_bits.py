"""Meaning of the bits of a solution's branch."""

SHOULDER_RIGHT = 1 << 0
ELBOW_DOWN = 1 << 1
WRIST_FLIP = 1 << 2
# Arms without shoulder and elbow number their solutions instead.
ARM_NUMBERED = 1 << 3
ARM_SHIFT = 4
ARM_MASK = 0xF << ARM_SHIFT
# The solution represents a continuum: joints can move while the pose does not.
SHOULDER_SINGULAR = 1 << 8
ELBOW_SINGULAR = 1 << 9
WRIST_SINGULAR = 1 << 10
# The same for an arm without named joints, or one posture of a redundant arm's self-motion.
SELF_MOTION = 1 << 13
CONTINUUM = SHOULDER_SINGULAR | ELBOW_SINGULAR | WRIST_SINGULAR | SELF_MOTION
# The posture has no name.
UNNAMED = 1 << 14
# The posture has only a number, stored in the bits of the arm's number.
POSTURE_NUMBERED = 1 << 15
# A singular posture without a continuum: two coincident solutions.
BOUNDARY = 1 << 11
# Axes 4 and 6 of a singular spherical wrist point in opposite directions.
WRIST_OPPOSED = 1 << 12

# Added to the number of solutions if the list may be incomplete.
DOUBT = 1 << 8
