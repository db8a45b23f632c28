"""The table of outcomes: how a request or a motion ends, as a number, a name and a meaning.

The numbers are those of ``robomech_interfaces/msg/ErrorCode``.  Statuses of results take theirs
from here, and nodes the code of a response.
"""

from enum import IntEnum


class Code(IntEnum):
    """Outcome of a request or a motion.

    0: success. 1xx: the request is wrong. 2xx: no solution exists, or the motion failed. 9xx: the
    node itself failed.

    Attributes
    ----------
    meaning : str
        In words.
    """

    meaning: str

    def __new__(cls, number: int, meaning: str) -> "Code":
        """Make a member of a number that knows what it means."""
        member = int.__new__(cls, number)
        member._value_ = number
        member.meaning = meaning
        return member

    NONE = 0, "success"

    UNKNOWN_LINK = 101, "a link that the robot description does not have"
    UNKNOWN_JOINT = 102, "a joint that the chain does not have"
    BAD_QUATERNION = 103, "a quaternion that is zero or far from unit length"
    NON_FINITE = 104, "a number that is NaN or infinite"
    FRAME_UNAVAILABLE = 105, "a frame_id without a transform to the base of the chain"
    SEED_OUTSIDE_LIMITS = 106, "a seed or start position outside the joint limits"
    NO_STATE = 107, "the present joint state is unknown, or the robot moves"
    WRONG_SIZE = 108, "an array of the wrong length, or a duplicate name"
    BAD_VALUE = 109, "a value outside its allowed range or set"
    MISSING_LIMITS = (110, "the robot lacks a velocity, acceleration or jerk limit that is needed")
    MISSING_INERTIA = 111, "the mass of a moving link is unknown"

    OUT_OF_REACH = 201, "the position cannot be reached, whatever the orientation"
    ORIENTATION_UNREACHABLE = 202, "the position can be reached, but not with this orientation"
    LIMITS_EXCLUDE_ALL = 203, "solutions exist, every one of them outside the joint limits"
    NOT_CONVERGED = 204, "an iterative solver found no solution; one may still exist"
    TIMED_OUT = 205, "the time limit was exceeded"
    SINGULAR_CONTINUUM = (206, "a continuum of solutions, none found inside the limits")
    UNDETERMINED = 207, "the samples do not determine the whole result"
    CONTRADICTORY = 208, "the samples contradict each other, or the specified setup"
    LOAD_NOT_HELD = 209, "no contact forces inside the friction cones hold the load"
    IK_LOST = 211, "along a path: no inverse-kinematic solution from here on"
    JUMP = 212, "along a path: the joints would have to jump"
    LIMIT = 213, "a joint, velocity, acceleration or jerk limit would be exceeded"
    SINGULAR = 214, "too close to a singularity: in a posture, or along a path"
    COLLISION = 215, "two bodies would touch: in a posture, or along a path"
    NO_PATH = 216, "no path around the obstacles was found in time"
    REJECTED = 221, "the trajectory or goal was rejected, or the controller has disconnected"
    PREEMPTED = 222, "a newer goal or trajectory took over, or the motion was stopped"
    PATH_TOLERANCE = 223, "a joint left the tolerance around the path"
    GOAL_TOLERANCE = 224, "a joint was outside the goal tolerance when the time limit was reached"

    INTERNAL = 900, "a bug in the node; please report it"
    NOT_INSTALLED = 901, "a required library is not installed"


_NAMES = {int(code): code.name for code in Code}


def name_of(code: int) -> str:
    """Return the name of a code, such as ``OUT_OF_REACH`` for 201."""
    return _NAMES.get(code, f"code {code}")
