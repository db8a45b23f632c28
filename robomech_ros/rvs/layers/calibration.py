"""A hand-eye calibration: its samples, the sensor, and how well it is known."""

from typing import Any

import numpy as np

from robomech_ros.calibration import HandEyeResult
from robomech_ros.rvs.model.calibration_view import calibration_facts, calibration_markers
from robomech_ros.rvs.model.camera import marker_points, visible_points
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.marker_nodes import MarkerNodes
from robomech_ros.rvs.page.surroundings import place_camera
from robomech_ros.rvs.page.tables import fact_table
from robomech_ros.typing import Array

SOURCE = "calibration"


class CalibrationLayer(Layer):
    """The layer.

    - ``tracking``: ``T_sensor_target`` of its samples (m), shape (n, 4, 4).
    """

    label, order, expanded = "Calibration", 5.7, True

    def __init__(self, context: LayerContext, result: HandEyeResult, tracking: Array) -> None:
        super().__init__(context)
        self._result = result
        chain, seen = context.chain, context.seen
        self._markers = calibration_markers(result, tracking, chain.base, chain.tip)
        self._nodes = MarkerNodes(context.server.scene, context.path)
        self._nodes.show(SOURCE, self._markers)
        # They would cover what is small.
        for what in ("ghosts", "gizmo"):
            context.switch(what, False)
        # Posture of the last sample, if the arm reaches it.
        context.arm.drag(result.robot_poses[-1])
        context.arm.release()
        at = context.arm.positions
        points = [visible_points(seen, [at]), marker_points(seen, self._markers, at)]
        place_camera(context.server, np.vstack(points))

    def _fill(self, folder: Folder, gui: Any) -> None:
        folder.checkbox(
            "shown", True, lambda on: self._nodes.show(SOURCE, self._markers if on is True else ())
        )
        folder.text().content = fact_table("calibration", calibration_facts(self._result))
