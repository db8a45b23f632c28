"""Masses, inertias and drives in the YAML form of a robot."""

import numpy as np

from robomech_ros.errors import RobomechError, RobotDescriptionError
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.documents.guarded_yaml import check_keys, read_flag
from robomech_ros.robots.drives import DRIVE_KEYS, Drive


def body_from_yaml(value: object, where: str) -> Body:
    """Read ``{mass, com: [x, y, z], inertia: {ixx, iyy, izz, ixy, ixz, iyz}, as_measured}``.

    The products of inertia are 0 where they are left out.  Whether a body can have these numbers
    is asked where they are used (:meth:`Body.fault`).

    - ``value``: from the document; kg, m and kg m^2, the inertia about the centre of mass.
    - ``where``: what the place is called in messages.
    """
    body = check_keys(value, where, ("mass", "com", "inertia"), ("as_measured",))
    moments = check_keys(
        body["inertia"], f"{where}: inertia", ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")
    )
    xx, xy, xz, yy, yz, zz = (
        moments.get(key, 0.0) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    as_measured = read_flag(body.get("as_measured", False), "as_measured", where)
    try:
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=np.float64)
        return Body(body["mass"], body["com"], inertia, as_measured)
    except (RobomechError, TypeError, ValueError) as error:
        raise RobotDescriptionError(where, str(error)) from None


def drive_from_yaml(value: object, where: str) -> Drive:
    """Read the fields of a :class:`Drive`, all of them optional."""
    drive = check_keys(value, where, (), DRIVE_KEYS)
    try:
        return Drive(**drive)
    except RobomechError as error:
        raise RobotDescriptionError(where, str(error)) from None
