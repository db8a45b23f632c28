"""Limbs of the Delta robot: a driven arm, and a forearm between two universal joints.

A forearm of two parallel rods and one of two universal joints with parallel axes let the platform
translate in the same way.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from robomech_ros._kernels.parallel.delta import delta_angles
from robomech_ros.parallel.argument_checks import translation_only
from robomech_ros.parallel.mechanism.limb import Axis, Limb, LimbBranches, chain_of_axes
from robomech_ros.parallel.mechanism.planar_limbs import one_or_two
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

_HALF = 0.5 * math.pi


def delta_limbs(name: str, geometry: Array, azimuths: Array, limits: Array) -> list[Limb]:
    """Make the limbs R U U at azimuths (3,) about z (rad), with limits (3, 2) of the arms (rad).

    The geometry (4,) is the radius of base and platform, arm and forearm (m).
    """
    base, platform, arm, forearm = geometry.tolist()
    limbs = []
    for i, azimuth in enumerate(azimuths.tolist()):
        leg = f"leg{i + 1}"
        r = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        across = np.array([-r[1], r[0], 0.0])
        elbow = (base + arm) * r
        ankle = elbow - [0.0, 0.0, forearm]
        low, high = limits[i].tolist()
        # Where all joints are at zero the arm is level and the forearm hangs down.
        axes = [
            Axis(f"{leg}_base", f"{leg}_arm", across, base * r, limits=(low, high)),
            Axis(f"{leg}_elbow_swing", f"{leg}_elbow_cross", across, elbow),
            Axis(f"{leg}_elbow_tilt", f"{leg}_forearm", r, elbow, limits=(-_HALF, _HALF)),
            Axis(f"{leg}_platform_tilt", f"{leg}_platform_cross", r, ankle, limits=(-_HALF, _HALF)),
            Axis(f"{leg}_platform_swing", f"{leg}_stud", across, ankle),
        ]
        T = assembled(np.eye(3), ankle - platform * r)
        tip = "platform" if i == 0 else f"{leg}_end"
        chain = chain_of_axes(name, axes, T, tip)
        limbs.append(Limb(chain, (f"{leg}_base",), partial(_solved, geometry, azimuths, i)))
    return limbs


def _solved(
    geometry: Array, azimuths: Array, limb: int, T: Array, drives: Array | None
) -> LimbBranches:
    point, angles, excess = translation_only(T), np.empty((3, 2)), np.empty(3)
    if drives is None:
        if delta_angles(geometry, azimuths, point, angles, excess) < 0:
            return LimbBranches(np.empty((0, 5)), (), continuum=True)
        if excess[limb]:
            return LimbBranches(np.empty((0, 5)), (), float(excess[limb]))
        drives = angles[limb]
    base, platform, arm, _ = geometry.tolist()
    azimuth = float(azimuths[limb])
    r = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    rows = []
    for q in drives.tolist():
        elbow = (base + arm * math.cos(q)) * r - [0.0, 0.0, arm * math.sin(q)]
        way = point + platform * r - elbow
        out, down = float(way @ r), -float(way[2])
        swing = math.atan2(-out, down)
        tilt = math.atan2(way[1] * r[0] - way[0] * r[1], math.hypot(out, down))
        turn = math.atan2(math.sin(swing - q), math.cos(swing - q))
        rows.append([q, turn, tilt, -tilt, -swing])
    return one_or_two(np.array(rows))
