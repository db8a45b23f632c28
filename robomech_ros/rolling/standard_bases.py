"""Bases of known kinds from their measures: the book's, and those that are sold.

Signs are those of the controllers of ros2_control, so that rates can be exchanged with them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.rolling.argument_checks import (
    above_zero,
    angle,
    check_entries,
    length as checked_length,
)
from robomech_ros.rolling.base import RollingBase
from robomech_ros.rolling.wheels import Wheel
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import ArrayLike


def differential_drive(
    radius: float, track: float, *, casters: Sequence[Wheel] = (), **options: Any
) -> RollingBase:
    """Make the book's base with two driven wheels on one axle, and casters.

    Parameters
    ----------
    radius, track : float
        Of the wheels, and between them (m).
    casters : sequence of Wheel, optional
        Of kind ``"caster"``.
    **options
        Of both wheels, such as ``max_rate``.

    Returns
    -------
    RollingBase
        With the wheels ``left`` and ``right``; the origin is in the middle of the axle.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.5.1.

    Examples
    --------
    >>> from robomech_ros.rolling import differential_drive
    >>> differential_drive(radius=0.1, track=0.4).wheel_rates([1.0, 0.5, 0.0]).round(9).tolist()
    [3.0, 7.0]
    """
    half = 0.5 * checked_length("track", track)
    both = _wheels(radius, [("left", 0.0, half), ("right", 0.0, -half)], kind="fixed", **options)
    check_entries("casters", casters, Wheel, "a list of wheels")
    return RollingBase([*both, *casters], name="differential_drive")


def omnidirectional(
    count: int, radius: float, distance: float, *, offset: float = 0.0, **options: Any
) -> RollingBase:
    """Make a base with omnidirectional wheels on a circle, evenly spaced.

    Parameters
    ----------
    count : int
        How many, 3 or more.
    radius, distance : float
        Of the wheels, and from the centre to them (m).
    offset : float, optional
        From x to the first of them, counter-clockwise as all (rad).
    **options
        Of all wheels, such as ``max_rate``.

    Returns
    -------
    RollingBase
        Positive rates of all wheels turn it clockwise.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.5.2.

    Examples
    --------
    >>> from robomech_ros.rolling import omnidirectional
    >>> base = omnidirectional(3, radius=0.1, distance=0.5)
    >>> base.wheel_rates([0.1, 0.1, 0.2]).round(6).tolist()
    [-2.5, 1.366025, -0.366025]
    """
    if type(count) is not int or not 3 <= count <= 100:
        raise BadValueError("count", count, "a number of wheels from 3 to 100")
    rho = checked_length("distance", distance)
    start = angle("offset", offset)
    wheels = list[Wheel]()
    for i in range(count):
        azimuth = start + 2.0 * math.pi * i / count
        place = f"wheel_{i + 1}", rho * math.cos(azimuth), rho * math.sin(azimuth)
        heading = azimuth - 0.5 * math.pi
        wheels += _wheels(radius, [place], kind="omni", heading=heading, **options)
    return RollingBase(wheels, name="omnidirectional")


def mecanum(
    radius: float, length: float, width: float, *, roller: float = 0.25 * math.pi, **options: Any
) -> RollingBase:
    """Make a base with four mecanum wheels.

    Parameters
    ----------
    radius, length, width : float
        Of the wheels; from the front axle to the rear one; from the left wheels to the right ones
        (m).
    roller : float, optional
        From the rolling direction of the rear left and front right wheels to the axes of their
        rollers on the ground (rad); minus that for the others.
    **options
        Of all wheels, such as ``max_rate``.

    Returns
    -------
    RollingBase
        With the wheels ``front_left``, ``front_right``, ``rear_right`` and ``rear_left``; positive
        rates drive forward.

    Raises
    ------
    BadValueError, UnderdeterminedError
        Not such values, or wheels that cannot give every twist.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.5.2.

    Examples
    --------
    >>> from robomech_ros.rolling import mecanum
    >>> mecanum(0.1, 0.6, 0.4).wheel_rates([0.2, 1.0, 0.5]).round(9).tolist()
    [4.0, 16.0, 6.0, 14.0]
    """
    x, y = (0.5 * checked_length(*one) for one in (("length", length), ("width", width)))
    to_axis = angle("roller", roller)
    corners = (("front_left", x, y, -to_axis), ("front_right", x, -y, to_axis),
               ("rear_right", -x, -y, -to_axis), ("rear_left", -x, y, to_axis))  # fmt: skip
    wheels = list[Wheel]()
    for *place, turn in corners:
        wheels += _wheels(radius, [place], kind="omni", roller=turn, **options)
    return RollingBase(wheels, name="mecanum")


def tricycle(
    radius: float, wheelbase: float, track: float, *, steering_limit: float = 0.5 * math.pi
) -> RollingBase:
    """Make a base with two wheels behind and a driven, steered one in front.

    Parameters
    ----------
    radius, wheelbase, track : float
        Of the wheels; from the rear axle to the front wheel; between the rear wheels (m).
    steering_limit : float, optional
        To both sides (rad).

    Returns
    -------
    RollingBase
        With the wheels ``front``, which drives, ``rear_right`` and ``rear_left``; the origin is in
        the middle of the rear axle.

    Examples
    --------
    >>> from robomech_ros.rolling import tricycle
    >>> base = tricycle(0.1, wheelbase=1.0, track=0.6)
    >>> base.steering_angles([1.0, 1.0, 0.0]).round(6).tolist(), base.mobility.type
    ([0.785398], '(1,1)')
    """
    half = 0.5 * checked_length("track", track)
    limits = _limits(steering_limit)
    front = "front", checked_length("wheelbase", wheelbase), 0.0
    wheels = _wheels(radius, [front], kind="steered", steering_limits=limits)
    rear = [("rear_right", 0.0, -half), ("rear_left", 0.0, half)]
    wheels += _wheels(radius, rear, kind="fixed", driven=False)
    return RollingBase(wheels, name="tricycle")


def ackermann(
    radius: float, wheelbase: float, track: float, *, steering_limit: float = 0.7, **options: Any
) -> RollingBase:
    """Make a car: two steered wheels in front, two driven ones behind.

    Parameters
    ----------
    radius, wheelbase, track : float
        Of the wheels; from axle to axle; from the left wheels to the right ones (m).
    steering_limit : float, optional
        Steering limit of each front wheel, to both sides (rad).
    **options
        Of the driven wheels, such as ``max_rate``.

    Returns
    -------
    RollingBase
        With the wheels ``rear_right`` and ``rear_left``, which drive, ``front_right`` and
        ``front_left``; the origin is in the middle of the rear axle.

    Examples
    --------
    >>> from robomech_ros.rolling import ackermann
    >>> car = ackermann(0.15, wheelbase=1.2, track=0.8)
    >>> car.wheel_rates([0.5, 1.0, 0.0]).round(6).tolist()
    [8.0, 5.333333]
    >>> car.steering_angles([0.5, 1.0, 0.0]).round(6).tolist()
    [0.463648, 0.643501]
    """
    half = 0.5 * checked_length("track", track)
    limits, x = _limits(steering_limit), checked_length("wheelbase", wheelbase)
    rear = [("rear_right", 0.0, -half), ("rear_left", 0.0, half)]
    front = [("front_right", x, -half), ("front_left", x, half)]
    wheels = _wheels(radius, rear, kind="fixed", **options)
    wheels += _wheels(radius, front, kind="steered", driven=False, steering_limits=limits)
    return RollingBase(wheels, name="ackermann")


def swerve(radius: float, positions: ArrayLike, **options: Any) -> RollingBase:
    """Make a base whose wheels are all driven and steered.

    Parameters
    ----------
    radius : float
        Radius of the wheels (m).
    positions : array_like, shape (n, 2)
        Positions of two wheels or more (m).
    **options
        Of all wheels, such as ``max_rate`` and ``max_steering_rate``.

    Examples
    --------
    >>> from robomech_ros.rolling import swerve
    >>> base = swerve(0.05, [[0.2, 0.2], [0.2, -0.2], [-0.2, -0.2], [-0.2, 0.2]])
    >>> base.mobility.type, base.wheel_rates([0.0, 0.0, 1.0]).round(6).tolist()
    ('(1,2)', [20.0, 20.0, 20.0, 20.0])
    """
    places = as_finite("positions", positions, (2,))
    if places.ndim != 2:
        raise WrongSizeError("positions", places.shape, "(n, 2)")
    named = [(f"wheel_{i + 1}", x, y) for i, (x, y) in enumerate(places.tolist())]
    wheels = _wheels(radius, named, kind="steered", **options)
    return RollingBase(wheels, name="swerve")


def _wheels(radius: float, places: Sequence[Sequence[Any]], **options: Any) -> list[Wheel]:
    """Make wheels of one kind; each place is a name, x and y (m)."""
    return [
        Wheel(position=np.array([x, y]), radius=radius, name=name, **options)
        for name, x, y in places
    ]


def _limits(steering_limit: float) -> tuple[float, float]:
    limit = above_zero("steering_limit", steering_limit, "rad")
    return -limit, limit
