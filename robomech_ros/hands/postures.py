"""Postures of fingers that touch an object in given contacts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import WrongSizeError
from robomech_ros.hands.contacts import Contact
from robomech_ros.hands.hand import Hand, fingers_of
from robomech_ros.kinematics import InverseKinematicsResult, inverse_kinematics
from robomech_ros.spatial.arrays import as_flag
from robomech_ros.spatial.poses import as_pose

__all__ = ["grasp_postures"]

_POSITION = (True, True, True, False, False, False)


def grasp_postures(
    hand: Hand,
    T: ArrayLike,
    contacts: Sequence[Contact],
    *,
    fingers: Sequence[int] | None = None,
    respect_limits: bool = True,
) -> tuple[InverseKinematicsResult, ...]:
    """Find all postures of the fingers in which their tips are in the contacts.

    Parameters
    ----------
    hand : Hand
    T : array_like, shape (4, 4)
        Pose of the object in the frame of the palm (m).
    contacts : sequence of Contact
        In the frame of the object, one for a finger.
    fingers : sequence of int, optional
        The number of the finger of each contact; default one after the other.
    respect_limits : bool, optional
        Whether postures outside the joint limits are left out.

    Returns
    -------
    tuple of InverseKinematicsResult
        Contact by contact: all branches of its finger, or the reason why there is none.  Fingers
        with more than three joints get samples.

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        As for :func:`hand_jacobian`, and for a pose that is none.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.hands import Contact, grasp_postures, load_hand
    >>> hand, T = load_hand("three_fingered"), np.eye(4)
    >>> T[2, 3] = 0.08
    >>> tip = Contact([0.04, 0.0, 0.0], [-1.0, 0.0, 0.0], "point", 0.5)
    >>> [len(found.q) for found in grasp_postures(hand, T, [tip])]
    [2]
    """
    given, owners = fingers_of(hand, contacts, fingers)
    pose = as_pose(T)
    if pose.shape != (4, 4):
        raise WrongSizeError("pose", pose.shape, (4, 4))
    respected = as_flag("respect_limits", respect_limits)
    found = []
    for contact, k in zip(given, owners, strict=True):
        target = np.eye(4)
        target[:3, 3] = pose[:3, :3] @ contact.position + pose[:3, 3]
        chain = hand.fingers[k]
        found.append(
            inverse_kinematics(chain, target, task_mask=_POSITION, respect_limits=respected)
        )
    return tuple(found)
