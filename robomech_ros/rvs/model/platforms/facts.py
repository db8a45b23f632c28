"""How far the pose of a platform is from singular, and what is lost or free there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.parallel import LoopSingularity, Mechanism, ParallelRobot, loop_singularity
from robomech_ros.parallel.kinetostatics.conditioning import scaled_matrices
from robomech_ros.typing import Array

ANGULAR = 3


@dataclass(frozen=True, eq=False)
class PlatformFacts:
    """Facts about a posture.

    Parameters
    ----------
    report : LoopSingularity
    weakest : ndarray, shape (6,)
        Twist of the platform, angular first, at its origin in the base (rad/s, m/s), that the
        drives hold least.
    mixed : bool
        Whether the platform both turns and moves along.
    """

    report: LoopSingularity
    weakest: Array
    mixed: bool

    @property
    def lines(self) -> list[tuple[str, str]]:
        """Facts as pairs of label and text."""
        report = self.report
        first, second = (f"{value:.3f}" for value in report.distances)
        lines = [
            ("here", report.summary),
            ("type 1", f"{first} away: a limb ends its reach, motions are lost; 0 is singular"),
            ("type 2", f"{second} away: motions are free, drives hold nothing; 0 is singular"),
            ("dexterity", f"{report.dexterity:.3f}; 1 is isotropic, 0 singular"),
        ]
        if self.mixed:
            lines.append(("length", f"{report.length:.4f} m, to compare turns with motions"))
        return lines


def platform_facts(robot: ParallelRobot | Mechanism, q: Array) -> PlatformFacts:
    """Judge a posture.

    Parameters
    ----------
    robot : StewartGough, Delta, Planar3RPR, Planar3RRR, Spherical3RRR or Mechanism
    q : ndarray, shape (n,)
        All joints (rad or m), loops closed.
    """
    mechanism = robot.mechanism
    T = mechanism.pose(q)
    own = q if isinstance(robot, Mechanism) else q[mechanism.drive_index]
    report = loop_singularity(robot, T, own)
    scaled = scaled_matrices(robot, T, own, report.length)
    weakest = scaled.motions @ np.linalg.svd(scaled.K)[2][-1]
    weakest[:ANGULAR] /= scaled.scale
    parts = scaled.motions[:ANGULAR], scaled.motions[ANGULAR:]
    return PlatformFacts(report, weakest, all(np.abs(part).max() > 1e-9 for part in parts))
