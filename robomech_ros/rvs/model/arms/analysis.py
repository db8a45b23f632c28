"""Analysis of an arm and its posture: conditioning, ellipsoids, singularities."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import (
    BestPosture,
    SingularityReport,
    best_conditioned_posture,
    characteristic_length,
    jacobian,
    manipulability_ellipsoid,
    nearest_singular_posture,
    reach_limits,
    singularity_report,
)
from robomech_ros.kinetostatics.conditioning import length_scale
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

# Rows of the Jacobian by kind, and the units of their velocities and forces.
ROWS = {"translation": slice(3, 6), "rotation": slice(0, 3)}
UNITS = {"translation": ("m/s", "N"), "rotation": ("rad/s", "N m")}
# In reaches of the arm: half an axis of the ellipsoid of a tip that moves with one reach a second,
# or turns with one rad/s; that of a force, at the same; and the least and the most that is drawn.
VELOCITY, FORCE = 0.3, 0.075
LEAST, MOST = 0.004, 0.5
# Length of an arrow in reaches, and negligible fraction of a twist.
ARROW, NONE = 0.35, 1e-3


@dataclass(frozen=True, eq=False)
class ArmFacts:
    """Facts that are the same in every posture of an arm.

    - ``least_reach``, ``greatest_reach``: distances of the tip from the first joint (m).
    """

    #: The characteristic length (m), or the size of an arm that has none.
    length: float
    #: Least condition number of all postures, without limits; infinite if all are singular.
    least_condition: float
    #: The best-conditioned posture inside the limits; None if all are singular.
    best: BestPosture | None
    least_reach: float
    greatest_reach: float


@dataclass(frozen=True, eq=False)
class PostureFacts:
    """Facts about a posture that need no search."""

    report: SingularityReport
    #: Twists that the tip cannot do in a singular posture; otherwise the one that takes the
    #: greatest effort.  Angular first, in the base (rad/s and m/s), shape (r, 6).
    twists: Array


@dataclass(frozen=True)
class NextSingularity:
    """The nearest singular posture."""

    #: Distance in joint values (rad), with slides divided by the characteristic length; infinite if
    #: no singular posture is found.
    distance: float
    #: Kinds of this singularity.
    kinds: tuple[str, ...]


class DrawnEllipsoid(NamedTuple):
    """A drawn ellipsoid, and its true half-axes."""

    #: Pose of its axes, with the tip as origin, in the base (m), shape (4, 4).
    pose: Array
    #: Lengths of the drawn half-axes (m), kept within visible bounds, shape (3,).
    half_axes: Array
    #: True half-axes, the longest first (m/s or rad/s, N or N m), shape (3,).
    values: Array
    unit: str


class TwistArrows(NamedTuple):
    """Arrows from the tip, in the base (m), each shape (k, 2, 3)."""

    #: Along linear velocities.
    linear: Array
    #: Along angular velocities.
    angular: Array


def arm_facts(chain: SerialChain) -> ArmFacts:
    """Compute the facts that hold in every posture of an arm; takes a second or two.

    - ``chain``: an arm with at least one joint.
    """
    reach = reach_limits(chain)
    try:
        length = characteristic_length(chain)
    except BadValueError:
        return ArmFacts(length_scale(chain), math.inf, None, *reach)
    best = best_conditioned_posture(chain, length=float(length))
    return ArmFacts(float(length), length.condition_number, best, *reach)


def posture_facts(chain: SerialChain, q: Array, length: float) -> PostureFacts:
    """Analyse a posture.

    - ``length``: divisor of linear motions (m).
    """
    report = singularity_report(chain, q, length=length)
    assert isinstance(report, SingularityReport)
    if report.singular:
        return PostureFacts(report, report.lost_directions)
    scale = np.repeat((1.0, length), 3)
    left = np.linalg.svd(jacobian(chain, q) / scale[:, None])[0]
    return PostureFacts(report, (left[:, report.rank - 1] * scale)[None])


def next_singularity(chain: SerialChain, q: Array, length: float) -> NextSingularity:
    """Search for the nearest singular posture, and name it; takes some 0.1 s.

    - ``chain``, ``q``, ``length``: as for :func:`posture_facts`.
    """
    found = nearest_singular_posture(chain, q, length=length)
    if not math.isfinite(found.distance):
        return NextSingularity(math.inf, ())
    report = singularity_report(chain, found.q, length=length)
    assert isinstance(report, SingularityReport)
    return NextSingularity(found.distance, report.kinds)


def drawn_ellipsoid(
    chain: SerialChain, q: Array, kind: str, part: str, reach: float
) -> DrawnEllipsoid:
    """Place the ellipsoid of velocities or of forces at the tip.

    - ``chain``, ``q``: as for :func:`posture_facts`.
    - ``kind``: one of "velocity", "force".
    - ``part``: one of "translation", "rotation".
    - ``reach``: size of the robot (m), which sets the same scale in all postures.
    """
    found = manipulability_ellipsoid(jacobian(chain, q)[ROWS[part]])
    one = reach if part == "translation" else 1.0
    if kind == "velocity":
        values, drawn = found.velocity, VELOCITY * reach / one * found.velocity
    else:
        values, drawn = found.force, FORCE * reach * one * found.force
    pose = assembled(found.axes, forward_kinematics(chain, q)[:3, 3])
    half_axes = np.clip(drawn, LEAST * reach, MOST * reach)
    return DrawnEllipsoid(pose, half_axes, np.sort(values)[::-1], UNITS[part][kind == "force"])


def twist_arrows(tip: Array, twists: Array, reach: float) -> TwistArrows:
    """Draw twists at the tip as arrows of one length.

    - ``tip``: position of the tip in the base (m), shape (3,).
    - ``twists``: twists, angular first, in the base (rad/s and m/s), shape (r, 6).
    """
    # Translations are scaled by the size of the arm for comparison with rotations.
    sizes = np.maximum(np.linalg.norm(twists * np.repeat((reach, 1.0), 3), axis=1), 1e-300)
    arrows = []
    for rows, weight in ((slice(3, 6), 1.0), (slice(0, 3), reach)):
        parts = twists[:, rows]
        lengths = np.linalg.norm(parts, axis=1)
        seen = weight * lengths > NONE * sizes
        ends = tip + ARROW * reach * parts[seen] / lengths[seen, None]
        arrows.append(np.stack((np.broadcast_to(tip, ends.shape), ends), axis=1))
    return TwistArrows(*arrows)
