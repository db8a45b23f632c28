"""Contours of the closure equations of a platform, whose crossings are its assembly modes."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel.equations import PlatformEquations, platform_equations
from robomech_ros.rvs.layers.contours import ContoursLayer
from robomech_ros.rvs.model.curve_drawing import ROOT
from robomech_ros.rvs.model.curve_problems import Axis, CurveProblem, Finding, equations_problem
from robomech_ros.rvs.page.curve_view import CurveView
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext, Switch
from robomech_ros.rvs.page.tables import small_text
from robomech_ros.typing import Array

_MISSING = (
    "Contours are drawn for planar and spherical platforms, and for six legs that end in pairs at "
    "three points of the platform."
)
_HINT = "Assembly modes are where both curves cross"
# Drives that are the same (rad or m).
_SAME = 1e-9


class PlatformContoursLayer(ContoursLayer):
    """The folder with the contours for the present values of the drives."""

    root, roots = "an assembly mode", "assembly modes"

    def __init__(self, place: LayerContext) -> None:
        Layer.__init__(self, place)
        self._view: CurveView | None = None
        self._on = False
        self._target: Array | None = None
        self._equations: PlatformEquations | None = None
        self._box: Any = None
        try:
            self._equations = self._at(place.platform.values)
        except BadValueError:
            return
        place.offered["contours"] = Switch(lambda: self._on, self._turn)

    def show(self) -> None:
        """Draw the contours of other values of the drives; nothing while they are off."""
        if self._view is None or self._view.removed or not self._on:
            return
        drives = self._place.platform.values
        if self._target is None or np.abs(drives - self._target).max() > _SAME:
            self._target = drives
            self._view.draw()

    def _fill(self, folder: Folder, gui: Any) -> None:
        if self._equations is None:
            folder.text().content = small_text([_MISSING])
            return
        self._box = folder.checkbox("contours", False, self._switch, _HINT)
        first, *rest = self._equations.names
        names = (f"closure, {first} and {rest[0]}", f"closure without {rest[-1]}")
        if len(rest) == 1:
            names = ("closure of limb 2", "closure of limb 3")
        self._view = CurveView(gui, self, names, (0, 1))
        self._view.show(False)

    def problem(self, pair: tuple[int, int]) -> CurveProblem | None:
        """Return the contours for the drives; None if they have been switched off."""
        drives = self._target
        if drives is None:
            return None
        self._equations = equations = self._at(drives)
        first, second = (Axis(name, "rad", -np.pi, np.pi) for name in equations.names[:2])
        return equations_problem(equations.curves, (first, second), pair, 2, 2.0 * np.pi)

    def disc(self, found: Finding) -> tuple[str, str]:
        """Return no number, and the colour of a root."""
        return "", ROOT

    def take(self, found: Finding) -> None:
        """Move the platform to an assembly mode, with the same drives."""
        equations, drives = self._equations, self._target
        if equations is None or drives is None:
            return
        platform = self._place.platform
        mechanism = platform.mechanism
        for angles in equations.solutions_at(*found.point.tolist()):
            rows = mechanism.postures(equations.pose(angles).real, seed=platform.q).q
            away = np.abs(rows[:, mechanism.drive_index] - drives)
            turns = np.where(mechanism.types[mechanism.drive_index] == 0, 2.0 * np.pi, np.inf)
            for q in rows[np.minimum(away, np.abs(turns - away)).max(axis=1) < 1e-6]:
                platform.move_to(q)
                return
        raise BadValueError("assembly mode", found.point.tolist(), "one within the joint limits")

    def _at(self, drives: Array) -> PlatformEquations:
        return platform_equations(self._place.platform.robot, drives)  # type: ignore[arg-type]
