"""The axes in which a request wants its answer expressed."""

import numpy as np
from numpy.typing import NDArray

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.error_codes import FrameUnavailableError
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.robots import SerialChain

__all__ = ["reference_axes"]

Array = NDArray[np.float64]


def reference_axes(model: RobotModel, frame: str, chain: SerialChain, q: Array) -> Array | None:
    """Give the rotation of a frame's axes in the base, shape (3, 3); None for the base itself.

    Parameters
    ----------
    model : RobotModel
        The robot.
    frame : str
        "" or the base, a frame fixed to it, or a link of the chain or fixed to one; with or
        without the prefix of frames.
    chain : SerialChain
        From the base to the link that the request is about.
    q : ndarray, shape (n,)
        Its joint values (rad or m).

    Raises
    ------
    FrameUnavailableError
        Any other frame.
    """
    moving = [link.name for link in chain.frames]
    link = model.link_of(frame)
    if link in moving and link not in model.fixed_frames:
        part = chain.with_tip(link)
        return forward_kinematics(part, q[: part.n])[:3, :3]
    try:
        fixed = model.frame_in_base(frame)
    except FrameUnavailableError:
        known = dict.fromkeys(map(model.frame_of, (*model.fixed_frames, *moving)))
        raise FrameUnavailableError(frame, known, "it is no frame of this chain") from None
    return None if fixed is None else fixed[:3, :3]
