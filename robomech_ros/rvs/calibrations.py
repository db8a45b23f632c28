"""Hand-eye calibrations in the browser, and in pages of their own."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.calibration import HandEyeResult
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.robots import RobotDescription, SerialChain, load_description
from robomech_ros.robots.robot_kinds import ARM
from robomech_ros.rvs.kind_registry import VIEW_KINDS
from robomech_ros.rvs.model.arms.arm import ArmView
from robomech_ros.rvs.model.calibration_view import calibration_facts, calibration_markers
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.opening import require_viser
from robomech_ros.rvs.serving.address import HOST, PORT
from robomech_ros.spatial import as_pose
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.page.page import RobotPage


def view_calibration(
    robot: str | os.PathLike[str],
    result: HandEyeResult,
    tracking: ArrayLike,
    *,
    port: int = PORT,
    host: str = HOST,
    base: str | None = None,
    tip: str | None = None,
) -> RobotPage:
    """Show a hand-eye calibration in a browser: samples, sensor, and how well it is known.

    Parameters
    ----------
    robot : str or path
        As for :func:`~robomech_ros.rvs.view`.
    result : HandEyeResult
        Result of n samples.
    tracking : array_like, shape (n, 4, 4)
        ``T_sensor_target`` of the samples (m), which the result was found from.
    port, host : int, str, optional
        As for ``view``.
    base, tip : str, optional
        Frames of base and hand in the samples; by default those of ``load_robot``.

    Returns
    -------
    RobotPage
        Served until it is closed.

    Raises
    ------
    WrongSizeError, BadValueError, NonFiniteError
        ``tracking`` is not one pose for each sample.
    ViewUnavailableError, PortTakenError, AddressError, UnknownRobotError, UnknownLinkError, \
RobotDescriptionError
        As for ``view``.

    See Also
    --------
    robomech_ros.calibration.hand_eye : what finds the result.
    """
    seen = _checked(result, tracking)
    description = load_description(robot)
    chain = description.chain(base, tip)
    require_viser()
    from robomech_ros.rvs.layers.calibration import CalibrationLayer
    from robomech_ros.rvs.page.page import RobotPage

    layers = VIEW_KINDS[ARM].make_layers()
    layers.append(partial(CalibrationLayer, result=result, tracking=seen))
    return RobotPage(description, chain, port=port, host=host, layers=layers, fixed=True)


def write_calibration(
    path: str | os.PathLike[str],
    description: RobotDescription,
    chain: SerialChain,
    result: HandEyeResult,
    tracking: ArrayLike,
    *,
    title: str = "",
) -> Path:
    """Write a hand-eye calibration as a page that shows it, in one file that needs nothing else.

    Parameters
    ----------
    path : str or path
        The file, as ``calibration.html``.
    description : RobotDescription
    chain : SerialChain
        From the base to the hand of the samples.
    result : HandEyeResult
        Result of n samples.
    tracking : array_like, shape (n, 4, 4)
        ``T_sensor_target`` of the samples (m).
    title : str, optional
        Above the page; default the name of the robot.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    BadValueError
        ``tracking`` is not one pose for each sample.
    ViewUnavailableError
        viser is not installed.
    OSError
        The file cannot be written.
    """
    seen = _checked(result, tracking)
    require_viser()
    from robomech_ros.rvs.page.recording import motion_page

    arm = ArmView(chain)
    # Posture of the last sample, if the arm reaches it.
    arm.drag(result.robot_poses[-1])
    markers = calibration_markers(result, seen, chain.base, chain.tip)
    notes = [f"{name}: {fact}" if name else fact for name, fact in calibration_facts(result)]
    still = Motion(chain, np.zeros(1), arm.q[None])
    name = title or description.name
    page = motion_page(description, still, name, markers=markers, notes=notes)
    Path(path).write_text(page, encoding="utf-8")
    return Path(path)


def _checked(result: HandEyeResult, tracking: ArrayLike) -> Array:
    if not isinstance(result, HandEyeResult):
        raise BadValueError("result", result, "what hand_eye gives")
    poses = np.asarray(tracking, dtype=np.float64)
    expected = (len(result.robot_poses), 4, 4)
    if poses.shape != expected:
        raise WrongSizeError("tracking", poses.shape, expected)
    return np.array([as_pose(T) for T in poses])
