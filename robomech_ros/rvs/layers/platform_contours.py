"""Contours of the closure equations of a platform, whose crossings are its assembly modes."""

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel.equations import PlatformEquations, platform_equations
from robomech_ros.rvs.layers.contours import ContoursLayer
from robomech_ros.rvs.model.curves.curve_problems import (
    Axis,
    CurveProblem,
    Finding,
    equations_problem,
)
from robomech_ros.typing import Array

_MISSING = (
    "Contours are drawn for planar and spherical platforms, and for six legs that end in pairs at "
    "three points of the platform."
)


class PlatformContoursLayer(ContoursLayer):
    """The folder with the contours for the present values of the drives."""

    root, roots = "an assembly mode", "assembly modes"
    hint = "Assembly modes are where both curves cross"
    same = 1e-9

    def _named(self) -> tuple[tuple[str, ...], str]:
        """Name the equations, or say why there are none."""
        try:
            self._equations = self._at(self._context.platform.values)
        except BadValueError:
            return (), _MISSING
        first, *rest = self._equations.names
        if len(rest) == 1:
            return ("closure of limb 2", "closure of limb 3"), ""
        return (f"closure, {first} and {rest[0]}", f"closure without {rest[-1]}"), ""

    def _drawn(self) -> tuple[Array, Array | None]:
        """Return the values of the drives; the platform is not marked."""
        return self._context.platform.values, None

    def problem(self, pair: tuple[int, int]) -> CurveProblem | None:
        """Return the contours for the drives; None if they have been switched off."""
        drives = self._target
        if drives is None:
            return None
        self._equations = equations = self._at(drives)
        first, second = (Axis(name, "rad", -np.pi, np.pi) for name in equations.names[:2])
        return equations_problem(equations.curves, (first, second), pair, 2, 2.0 * np.pi)

    def _number(self, found: Finding) -> int | None:
        """Return None: assembly modes have no number in the table."""

    def take(self, found: Finding) -> None:
        """Move the platform to an assembly mode, with the same drives."""
        equations, drives = self._equations, self._target
        if drives is None:
            return
        platform = self._context.platform
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
        return platform_equations(self._context.platform.robot, drives)  # type: ignore[arg-type]
