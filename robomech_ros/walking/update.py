"""Result of one period of walking."""

from __future__ import annotations

from dataclasses import dataclass

from robomech_ros.typing import Array, BoolArray


@dataclass(frozen=True, slots=True, eq=False)
class WalkUpdate:
    """Result of one period of walking.

    Attributes
    ----------
    q, rates : ndarray, shape (3 k,)
        All joints, and their mean rates over the period (rad or m, and s).
    contacts : ndarray of bool, shape (k,)
        Which feet stand.
    feet : ndarray, shape (k, 3)
        Over the ground (m).
    base : ndarray, shape (3,)
        x, y (m) and yaw (rad) over the ground of the frame that moves with the command.
    trunk : ndarray, shape (4, 4)
        Pose of the trunk over the ground (m).
    twist : ndarray, shape (3,)
        [w, vx, vy] of that frame in its own axes (rad/s, m/s).
    margin : float
        Static stability margin (m).
    part : float
        Part of the commanded twist that feet and joints allow, 1 where nothing limits it.
    walking : bool
        Whether feet move; if not, all are down.
    """

    q: Array
    rates: Array
    contacts: BoolArray
    feet: Array
    base: Array
    trunk: Array
    twist: Array
    margin: float
    part: float
    walking: bool
