"""Limits of a robot with a gait: stride lengths and trunk poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.walking.gait_step import Pattern
from robomech_ros._kernels.walking.legs import follow_feet
from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.spatial import matrix_from_euler_angles
from robomech_ros.typing import Array
from robomech_ros.walking.gaits import Gait
from robomech_ros.walking.robot import LeggedRobot
from robomech_ros.walking.support import stability_margin

STATIC_BOUND, TROT_BOUND = 0.01, -0.04
# Part of what the margin leaves that feet use; the rest is left to poses of the trunk.
_FOR_FEET = 0.7
# Part of the circle within reach of the level robot that feet use, for the same reason.
_OF_REACH = 0.7
_LEAST_RADIUS = 0.004
_AROUND = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
# Parts of what feet leave that poses of the trunk use, of one that sways and of others, and that
# their acceleration uses; the sway has the rest.
_FOR_POSES_OF_SWAY, _FOR_POSES, _FOR_LEAN = 0.4, 0.8, 0.1
# Part of the weight that a trunk on its way takes from the feet.
_OF_WEIGHT = 0.25
# Greatest acceleration of a way of 1 m that takes 1 s, from rest to rest (m/s^2).
_FASTEST = 10.0 / np.sqrt(3.0)
GRAVITY = 9.81
# Part of the depth of a triangle to which the trunk sways.
_DEEP = 0.9


@dataclass(frozen=True)
class TrunkPoseCheck:
    """Check of a trunk pose.

    Attributes
    ----------
    status : Code
        NONE, LIMIT where a joint would leave its limits, OUT_OF_REACH where a leg is too short,
        BAD_VALUE where the robot would tip.
    leg, joint : str
        Those in the way, empty where there are none.
    reason : str
        In words.
    """

    status: Code
    leg: str = ""
    joint: str = ""
    reason: str = ""


@dataclass(frozen=True, eq=False)
class Stride:
    """A robot with a gait, and the margin (m) that is kept, its bound.

    The mass centre may move to the side by ``spare`` (m) by poses of the trunk, and the zero-moment
    point from there by ``lean`` (m) on the way to them. Geometry, settings and level are as the
    kernel of walking reads them.
    """

    gait: Gait
    bound: float
    spare: float
    lean: float
    geometry: Array
    settings: Array
    level: Array

    @property
    def pattern(self) -> Pattern:
        """Geometry and settings together."""
        return Pattern(self.geometry, self.settings)

    def start(self, phase: float) -> float:
        """Return the next phase at which a walk can begin."""
        if not self.gait.sways:
            return phase
        begins = float(self.gait.duty) - self.geometry[:, 2] - self.settings[4]
        return float(phase + ((begins - phase) % 1.0).min())

    def pose(self, offset: Array) -> Array:
        """Return the trunk for an offset, x, y, z and roll, pitch, yaw, as the kernel reads it."""
        pose = self.level.copy()
        turn = matrix_from_euler_angles([offset[5], offset[4], offset[3]], "ZYX")
        pose[:9] = turn.ravel()
        pose[9:12] += offset[:3]
        return pose

    def _centre(self, pose: Array) -> Array:
        """Return the mass centre of a pose, in the walking frame, shape (3,)."""
        return pose[9:12] + pose[:9].reshape(3, 3) @ pose[12:15]

    def quickest(self, start: Array, end: Array) -> float:
        """Return the shortest time (s) for a way between two offsets.

        Its acceleration shifts the zero-moment point by `lean` at most, and takes no more than a
        part of the weight from the feet.
        """
        x, y, z = self._centre(self.pose(end)) - self._centre(self.pose(start))
        height = self._centre(self.level)[2]
        lifted = abs(z) / (_OF_WEIGHT * GRAVITY)
        aside = np.hypot(x, y) * height / (GRAVITY * self.lean)
        return float(np.sqrt(_FASTEST * max(lifted, aside)))

    def possible(self, robot: LeggedRobot, offsets: Sequence[Array]) -> TrunkPoseCheck:
        """Return whether the trunk can be at all of some offsets with feet in their circles."""
        poses = [self.pose(offset) for offset in offsets]
        centres = [self._centre(pose)[:2] for pose in poses]
        away = np.array(centres) - self.level[9:11] - self.level[12:14]
        off = float(np.hypot(*away.T).max())
        if off > self.spare:
            weakest = np.argmin(_depths(robot, self.gait, self.geometry))
            leg = robot.leg_names[int(weakest)]
            why = (
                f"the mass centre would move {off:.4g} m to the side, and the margin of the "
                f"gait '{self.gait.name}' allows {self.spare:.4g} m when leg '{leg}' is lifted"
            )
            return TrunkPoseCheck(Code.BAD_VALUE, leg, "", why)
        for pose in poses:
            answer = reachable(robot, self.geometry, self.settings, pose)
            if answer.status != Code.NONE:
                return answer
        return TrunkPoseCheck(Code.NONE)


def _depths(robot: LeggedRobot, gait: Gait, geometry: Array) -> Array:
    """Return the least margin (m) with each leg lifted, the feet at their places."""
    least = np.full(len(robot.legs), np.inf)
    for standing in gait.stances(len(robot.legs)):
        up = [k for k, stands in enumerate(standing) if not stands]
        centre = robot.mass_centre[:2]
        if gait.sways and up:
            centre = centre + geometry[up[0], 3:5]
        margin = float(stability_margin(centre, geometry[list(standing), :2]))
        least[up] = np.minimum(least[up], margin)
    return least


def _sways(robot: LeggedRobot, places: Array) -> Array:
    """Find where the trunk sways before each leg is lifted: towards the middle of the others."""
    found = np.zeros((len(places), 2))
    for k in range(len(places)):
        a, b, c = np.delete(places, k, axis=0)[:3]
        sides = np.array([np.hypot(*(b - c)), np.hypot(*(c - a)), np.hypot(*(a - b))])
        centre = sides @ np.array([a, b, c]) / sides.sum()
        found[k] = _DEEP * (centre - robot.mass_centre[:2])
    return found


def reachable(robot: LeggedRobot, geometry: Array, settings: Array, pose: Array) -> TrunkPoseCheck:
    """Return whether all legs reach all of their circles, on the ground and lifted."""
    radius = float(settings[3])
    sway = np.hypot(*geometry[:, 3:5].T).max()
    turn, place = pose[:9].reshape(3, 3), pose[9:12]
    count = len(robot.legs)
    for height in (0.0, float(settings[2])):
        for angle in _AROUND:
            away = (radius + sway) * np.array([np.cos(angle), np.sin(angle)])
            points = np.column_stack([geometry[:, :2] + away, np.full(count, height)])
            feet = np.ascontiguousarray((points - place) @ turn)
            q = robot.home.reshape(count, 3).copy()
            lost = int(follow_feet(robot.packed, feet, q))
            if lost >= 0:
                leg = robot.leg_names[lost]
                joint = robot.legs[lost].joint_names[-1]
                why = f"leg '{leg}' is too short, even with joint '{joint}' stretched out"
                return TrunkPoseCheck(Code.OUT_OF_REACH, leg, joint, why)
            flat = q.ravel()
            excess = np.maximum(robot.lower - flat, flat - robot.upper)
            worst = int(np.argmax(excess))
            if excess[worst] > 0.0:
                leg, joint = robot.leg_names[worst // 3], robot.joint_names[worst]
                why = (
                    f"joint '{joint}' of leg '{leg}' would be {excess[worst]:.4f} outside its "
                    f"limits [{robot.lower[worst]:.4f}, {robot.upper[worst]:.4f}]"
                )
                return TrunkPoseCheck(Code.LIMIT, leg, joint, why)
    return TrunkPoseCheck(Code.NONE)


def stride_of(robot: LeggedRobot, gait: Gait, lift: float, bound: float | None) -> Stride:
    """Find the allowed offsets of feet within reach and balance, for a cycle of 1 s."""
    least = (STATIC_BOUND if gait.static else TROT_BOUND) if bound is None else bound
    feet = robot.feet(robot.home)
    phases = np.array([float(one) for one in gait.phases(len(robot.legs))])
    geometry = np.zeros((len(robot.legs), 5))
    geometry[:, :2], geometry[:, 2] = feet[:, :2], phases
    sway = 0.0
    if gait.sways:
        geometry[:, 3:5] = _sways(robot, feet[:, :2])
        sway = 1.0 / len(robot.legs) - (1.0 - float(gait.duty))
    of_legs = _depths(robot, gait, geometry)
    deepest = float(of_legs.min())
    budget = deepest - least
    leg = robot.leg_names[int(np.argmin(of_legs))]
    if budget <= 0.0:
        what = f"margin of the gait '{gait.name}' with leg '{leg}' lifted"
        raise BadValueError(what, deepest, f"more than the bound {least:g} m")
    level = np.zeros(15)
    level[:9], level[11], level[12:] = np.eye(3).ravel(), -feet[:, 2].mean(), robot.mass_centre
    # No leg reaches further, whatever margin is allowed.
    radius = min(_FOR_FEET * budget, 2.0 * float(np.linalg.norm(feet, axis=1).max()))
    while True:
        settings = np.array([1.0, float(gait.duty), lift, radius, sway, 0.0])
        answer = reachable(robot, geometry, settings, level)
        if answer.status == Code.NONE:
            radius = settings[3] = _OF_REACH * radius
            left = budget - radius
            spare = (_FOR_POSES_OF_SWAY if gait.sways else _FOR_POSES) * left
            return Stride(gait, least, spare, _FOR_LEAN * left, geometry, settings, level)
        radius *= 0.8
        if radius < _LEAST_RADIUS:
            raise BadValueError("home of the robot", robot.home.tolist(), answer.reason)
