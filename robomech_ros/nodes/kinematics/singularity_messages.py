"""Encoding of what a posture's Jacobian says."""

from typing import Any

import numpy as np
from geometry_msgs.msg import TwistStamped
from numpy.typing import NDArray

from robomech_ros.kinetostatics import SingularityReport
from robomech_ros.nodes.common.message_fields import floats

__all__ = ["encode_report"]

Array = NDArray[np.float64]


def encode_report(report: SingularityReport, axes: Array | None, frame: str, response: Any) -> Any:
    """Fill an AnalyzeSingularity response.

    Parameters
    ----------
    report : SingularityReport
    axes : ndarray, shape (3, 3), or None
        Rotation of the frame in the base in whose axes lost directions are given; None = base.
    frame : str
        Its name.
    response : AnalyzeSingularity.Response
    """
    response.singular_values = floats(report.singular_values)
    response.rank = report.rank
    response.manipulability = report.manipulability
    response.condition_number = report.condition_number
    response.characteristic_length = report.length
    response.normalised_condition_number = report.normalised_condition_number
    response.lost_directions = [_twist(twist, axes, frame) for twist in report.lost_directions]
    response.singularity_types = list(report.kinds)
    response.summary = _summary(report)
    return response


def _twist(twist: Array, axes: Array | None, frame: str) -> TwistStamped:
    angular, linear = twist.reshape(2, 3) if axes is None else twist.reshape(2, 3) @ axes
    message = TwistStamped()
    message.header.frame_id = frame
    for vector, values in ((message.twist.angular, angular), (message.twist.linear, linear)):
        vector.x, vector.y, vector.z = values.tolist()
    return message


def _summary(report: SingularityReport) -> str:
    if not report.singular:
        # More joints than freedoms leave singular values of zero, which say nothing of the posture.
        largest, least = report.singular_values[0], report.singular_values[report.rank - 1]
        return (
            f"regular: rank {report.rank}, least singular value {least:.3g} "
            f"and condition number {largest / least:.4g} with lengths over {report.length:.4g} m"
        )
    lost = len(report.lost_directions)
    directions = f"{lost} direction{'s' if lost != 1 else ''} of motion lost"
    return f"singular ({', '.join(report.kinds)}): rank {report.rank}, {directions}"
