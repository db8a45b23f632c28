"""Drawing of a hand-eye calibration: samples, target, sensor, and its uncertainty."""

import math

import numpy as np

from robomech_ros.calibration import HandEyeResult
from robomech_ros.rvs.model.running.live_robot import ViewMarker
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

Rgba = tuple[float, float, float, float]

# Square of the radius that holds 95 % of three normal numbers of variance 1.
CHI_SQUARE_95 = 7.8147
# Parts of the distance between sensor and target: axes of samples, length of the frustum, width of
# the target, longest half axis of the ellipsoid as it is drawn.
AXES, DEPTH, PLATE, LONGEST = 0.08, 0.2, 0.2, 0.15
# Half the opening of the frustum across and along, as parts of its length.
OPENING = (0.5, 0.375)
# Default distance between sensor and target (m).
NO_DISTANCE = 0.2
# Least thickness of an ellipsoid over its longest axis: a flat one would be invisible.
FLAT = 0.02
RED, GREEN, BLUE = (0.85, 0.15, 0.15, 1.0), (0.1, 0.6, 0.2, 1.0), (0.15, 0.35, 0.9, 1.0)
SENSOR, ELLIPSOID, TARGET = (0.1, 0.45, 0.85, 1.0), (0.95, 0.55, 0.1, 0.45), (0.3, 0.3, 0.35, 0.8)
TEXT: Rgba = (0.1, 0.1, 0.1, 1.0)
NO_POINTS = np.empty((0, 3))
UNSOLVED: Rgba = (0.5, 0.5, 0.5, 1.0)
# Colours of a residual equal to the noise, and of one three times as large.
GOOD, POOR, MOST = (0.1, 0.6, 0.25), (0.95, 0.65, 0.1), 3.0


def residual_ratios(result: HandEyeResult) -> Array:
    """Compare the residuals of samples with the noise.

    - ``result``: calibration from n samples.

    Returns an array (n,): angle or distance over its root mean square from the noise, whichever
    ratio is greater.
    """
    noise = np.maximum([result.noise.rotation, result.noise.position], 1e-12)
    return (result.residuals / (math.sqrt(3.0) * noise)).max(axis=1, initial=0.0)


def position_half_axes(result: HandEyeResult) -> tuple[Array, Array]:
    """Return the ellipsoid that has the sensor's position with a probability of 95 %.

    Directions that are free are left out of it.

    Returns the half-axes (m), the longest first, shape (3,), and a rotation (3, 3), whose columns
    are their directions in the frame of ``result.sensor``'s parent.
    """
    values, axes = np.linalg.eigh(result.determined_covariance)
    values, axes = np.maximum(values[::-1], 0.0), axes[:, ::-1].copy()
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return np.sqrt(CHI_SQUARE_95 * values), axes


def drawing_factor(longest: float, room: float) -> float:
    """Return the scale of a drawing: 1, 2, 5, 10, ... as space allows.

    - ``longest``, ``room``: its size, and the largest size of the drawing (m).
    """
    if not longest > 0.0 or room <= longest:
        return 1.0
    power = 10.0 ** math.floor(math.log10(room / longest))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power * longest <= room))


def sample_markers(robot: Array, tracking: Array, base: str) -> list[ViewMarker]:
    """Draw unsolved samples, each as a frame of the hand and a grey ball.

    - ``robot``, ``tracking``: ``T_base_hand`` and ``T_sensor_target`` (m), shape (n, 4, 4).
    - ``base``: frame of the robot's base.
    """
    return _samples(robot, [UNSOLVED] * len(robot), _distance(tracking), base)


def calibration_markers(
    result: HandEyeResult, tracking: Array, base: str, hand: str
) -> list[ViewMarker]:
    """Draw a calibration: samples, sensor, target, and the ellipsoid of the sensor's position.

    - ``result``: calibration from n samples.
    - ``tracking``: ``T_sensor_target`` of the samples (m), shape (n, 4, 4).
    - ``base``, ``hand``: frames of the robot's base and hand.

    Returns the markers: a ball for each sample, from green to amber as its residual grows to
    three times what the noise makes, red where it was left out; a frustum that opens along the axis
    of the sensor nearest to where it saw the target; the ellipsoid of 95 %, larger by a factor that
    is written beside it.
    """
    parent, other = (hand, base) if result.mount == "eye-in-hand" else (base, hand)
    distance = _distance(tracking)
    colours = [
        RED if not used else _colour_of(ratio)
        for ratio, used in zip(residual_ratios(result).tolist(), result.inlier, strict=True)
    ]
    half_axes, axes = position_half_axes(result)
    factor = drawing_factor(float(half_axes[0]), LONGEST * distance)
    place = assembled(axes, result.sensor[:3, 3])
    drawn = factor * np.maximum(half_axes, FLAT * max(float(half_axes[0]), 1e-9))
    x, y, z = (2.0 * drawn).tolist()
    plate = PLATE * distance
    sizes = (plate, plate, 0.02 * plate)
    frustum = _frustum(result.sensor, tracking, DEPTH * distance, parent)
    corner = assembled(np.eye(3), frustum.points[1])
    label = f"95 %: {1e3 * half_axes[0]:.2g} mm" + (f", drawn x {factor:g}" if factor > 1 else "")
    return [
        *_samples(result.robot_poses, colours, distance, base),
        *_axes("target_axes", other, result.target[None], 0.6 * plate, 0.02 * plate),
        ViewMarker("target", other, "box", result.target, sizes, NO_POINTS, TARGET),
        frustum,
        ViewMarker("uncertainty", parent, "sphere", place, (x, y, z), NO_POINTS, ELLIPSOID),
        _text("uncertainty_label", parent, corner, label, AXES * distance),
    ]


def calibration_facts(result: HandEyeResult) -> list[tuple[str, str]]:
    """Describe the result and the residuals of every sample, as pairs of name and fact."""
    x, y, z = result.sensor[:3, 3].tolist()
    half_axes, _ = position_half_axes(result)
    sizes = ", ".join(f"{1e3 * value:.3g}" for value in half_axes)
    noise = result.noise
    facts = [
        ("mount", result.mount),
        ("sensor", f"at {x:.4f} {y:.4f} {z:.4f} m"),
        ("95 % ellipsoid", f"half axes {sizes} mm"),
        ("one deviation", f"{1e3 * result.rotation_deviation:.3g} mrad at the worst axis"),
        ("noise", f"{1e3 * noise.position:.3g} mm, {1e3 * noise.rotation:.3g} mrad"),
    ]
    facts.append(("samples", "residuals, times the noise: 1 is green, 3 amber"))
    rows = zip(result.residuals.tolist(), residual_ratios(result), result.inlier, strict=True)
    for number, ((angle, distance), ratio, used) in enumerate(rows):
        text = f"{1e3 * distance:.3g} mm, {1e3 * angle:.3g} mrad, x {ratio:.1f}"
        facts.append((f"sample {number}", text if used else f"left out: {text}"))
    return facts


def _distance(tracking: Array) -> float:
    """Typical distance (m) between sensor and target, or a size of its own."""
    lengths = np.linalg.norm(tracking[:, :3, 3], axis=1)
    distance = float(np.median(lengths)) if len(lengths) else 0.0
    return distance if distance > 1e-3 else NO_DISTANCE


def _colour_of(ratio: float) -> Rgba:
    part = min(max((ratio - 1.0) / (MOST - 1.0), 0.0), 1.0)
    red, green, blue = (a + part * (b - a) for a, b in zip(GOOD, POOR, strict=True))
    return red, green, blue, 1.0


def _samples(robot: Array, colours: list[Rgba], distance: float, base: str) -> list[ViewMarker]:
    if not len(robot):
        return []
    length = AXES * distance
    markers = _axes("samples", base, robot, length, 0.06 * length)
    for number, (T, colour) in enumerate(zip(robot, colours, strict=True)):
        width = (0.8 if colour == RED else 0.4) * length
        name = f"sample_{number}"
        sizes = (width, width, width)
        markers.append(ViewMarker(name, base, "sphere", T, sizes, NO_POINTS, colour))
        if colour == RED:
            markers.append(_text(f"left_out_{number}", base, T, f"{number}: left out", length))
    return markers


def _axes(name: str, link: str, poses: Array, length: float, width: float) -> list[ViewMarker]:
    """Draw the axes of frames (n, 4, 4) as lines, all x at once, all y, all z."""
    markers = []
    for k, colour in enumerate((RED, GREEN, BLUE)):
        starts = poses[:, :3, 3]
        points = np.stack((starts, starts + length * poses[:, :3, k]), axis=1).reshape(-1, 3)
        markers.append(_lines(f"{name}_{'xyz'[k]}", link, points, width, colour))
    return markers


def _frustum(sensor: Array, tracking: Array, depth: float, link: str) -> ViewMarker:
    """Draw a pyramid from the sensor along that of its axes which is nearest to the target."""
    towards = tracking[:, :3, 3].sum(axis=0) if len(tracking) else np.array([0.0, 0.0, 1.0])
    k = int(np.argmax(np.abs(towards)))
    ahead = np.zeros(3)
    ahead[k] = depth if towards[k] >= 0.0 else -depth
    across, along = np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3]
    corners = [
        ahead + depth * (i * OPENING[0] * across + j * OPENING[1] * along)
        for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    ends = [(np.zeros(3), corner) for corner in corners]
    ends += [(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    points = np.array(ends).reshape(-1, 3) @ sensor[:3, :3].T + sensor[:3, 3]
    return _lines("sensor", link, points, 0.03 * depth, SENSOR)


def _lines(name: str, link: str, points: Array, width: float, colour: Rgba) -> ViewMarker:
    return ViewMarker(name, link, "lines", np.eye(4), (width, 0.0, 0.0), points, colour)


def _text(name: str, link: str, T: Array, text: str, height: float) -> ViewMarker:
    return ViewMarker(name, link, "text", T, (0.0, 0.0, height), NO_POINTS, TEXT, text)
