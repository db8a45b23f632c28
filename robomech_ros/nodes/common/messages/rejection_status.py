"""Diagnostics of trajectories that a controller rejected, with their senders."""

import zlib
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from trajectory_msgs.msg import JointTrajectory

_COUNT, _TEXT = "refused", "last refusal"
_CODE, _LABEL, _RUN = "last refusal code", "last refused trajectory", "counted since"


class Refusal(NamedTuple):
    """The trajectory that a controller refused last."""

    number: int  #: Number of refused trajectories so far.
    code: int  #: One of `Code`; 0 if the latest trajectory was accepted.
    text: str  #: The reason; empty if none was refused.
    label: str  #: Label of the trajectory, see `trajectory_label`; may be empty.
    #: A text that is different after each start of the controller; empty if unknown.
    run: str = ""


def refusal_values(refusal: Refusal) -> dict[str, object]:
    """Return a refusal as facts of a status."""
    return {
        _COUNT: refusal.number,
        _TEXT: refusal.text,
        _CODE: refusal.code,
        _LABEL: refusal.label,
        _RUN: refusal.run,
    }


def read_refusal(values: Mapping[str, str]) -> Refusal | None:
    """Read a refusal from the facts of a status; None if they are missing."""
    try:
        numbers = int(values[_COUNT]), int(values[_CODE])
        return Refusal(*numbers, values[_TEXT], str(values[_LABEL]), values.get(_RUN, ""))
    except (KeyError, ValueError):
        return None


def trajectory_label(message: JointTrajectory) -> str:
    """Return a fingerprint of a trajectory: stamp, size, and a sum of its ends."""
    stamp, points = message.header.stamp, message.points
    total = zlib.crc32("\n".join(message.joint_names).encode())
    for point in points[:1] + points[-1:]:
        total = zlib.crc32(np.asarray(point.positions, dtype=np.float64).tobytes(), total)
        total = zlib.crc32(f"{point.time_from_start}".encode(), total)
    return f"{stamp.sec}.{stamp.nanosec:09d} {len(points)} {total:08x}"
