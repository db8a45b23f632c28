"""Names of postures, from the bits that the solvers give them."""

from functools import lru_cache

from robomech_ros._kernels.inverse import branch_bits as bit

__all__ = ["branch_name"]

_SINGULAR = (
    (bit.SHOULDER_SINGULAR, "shoulder-singular"),
    (bit.ELBOW_SINGULAR, "elbow-singular"),
    (bit.WRIST_SINGULAR, "wrist-singular"),
    (bit.SELF_MOTION, "self-motion"),
    (bit.BOUNDARY, "at-boundary"),
)


@lru_cache(maxsize=1024)
def branch_name(branch: int) -> str:
    """Name a posture, such as ``"shoulder-left elbow-up wrist-flip"``.

    Parameters
    ----------
    branch : int
        Bits of ``_kernels.branch_bits``.

    Returns
    -------
    str
        Empty for a posture that has no name.
    """
    if branch & bit.UNNAMED:
        return ""
    number = ((branch & bit.ARM_MASK) >> bit.ARM_SHIFT) + 1
    if branch & bit.POSTURE_NUMBERED:
        words = [f"posture-{number}"]
    elif branch & bit.ARM_NUMBERED:
        words = [f"arm-{number}"]
    else:
        words = [
            "shoulder-right" if branch & bit.SHOULDER_RIGHT else "shoulder-left",
            "elbow-down" if branch & bit.ELBOW_DOWN else "elbow-up",
        ]
    if not branch & bit.POSTURE_NUMBERED:
        words.append("wrist-flip" if branch & bit.WRIST_FLIP else "wrist-noflip")
    words += [word for mark, word in _SINGULAR if branch & mark]
    return " ".join(words)
