"""A hand-eye calibration: its samples, the sensor, and how well it is known."""

from __future__ import annotations

import numpy as np

from robomech_ros.calibration import HandEyeResult
from robomech_ros.rvs.model.calibration_view import calibration_facts, calibration_markers
from robomech_ros.rvs.model.camera import marker_points, visible_points
from robomech_ros.rvs.page.clients import Controls
from robomech_ros.rvs.page.fact_table import fact_table
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.marker_nodes import MarkerNodes
from robomech_ros.rvs.page.surroundings import place_camera
from robomech_ros.typing import Array

ORDER = 5.7
SOURCE = "calibration"


class CalibrationLayer:
    """The layer.

    Parameters
    ----------
    place : LayerContext
    result : HandEyeResult
    tracking : ndarray, shape (n, 4, 4)
        ``T_sensor_target`` of its samples (m).
    """

    def __init__(self, place: LayerContext, result: HandEyeResult, tracking: Array) -> None:
        self._place, self._result = place, result
        chain = place.chain
        self._markers = calibration_markers(result, tracking, chain.base, chain.tip)
        self._nodes = MarkerNodes(place.server.scene, place.path)
        self._shown = True
        self._nodes.show(SOURCE, self._markers)
        # They would cover what is small.
        for what in ("ghosts", "gizmo"):
            place.switch(what, False)
        # Where the last sample was taken, if the arm gets there.
        place.arm.drag(result.robot_poses[-1])
        place.arm.release()
        place_camera(place.server, self._points())

    def show(self) -> None:
        """Do nothing: what is drawn moves with the links."""

    def controls(self, client: object) -> Controls:
        """Give a browser the folder "Calibration"."""
        folder = Folder(client.gui, self._place.units, "Calibration", ORDER, expanded=True)  # type: ignore[attr-defined]
        with folder:
            folder.checkbox("shown", self._shown, self._turn)
            folder.text().content = fact_table("calibration", calibration_facts(self._result))
        return folder

    def close(self) -> None:
        """Do nothing: nothing runs."""

    def _turn(self, shown: bool) -> None:
        def turned() -> None:
            self._shown = shown is True
            self._nodes.show(SOURCE, self._markers if self._shown else ())

        self._place.run((self, "shown"), turned)

    def _points(self) -> Array:
        seen, at = self._place.seen, self._place.arm.positions
        return np.vstack([visible_points(seen, [at]), marker_points(seen, self._markers, at)])
