"""Contours of two equations over joints 4 and 5, whose crossings are the postures of the arm."""

import math
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from robomech_ros.rvs.model.curves.curve_drawing import ROOT
from robomech_ros.rvs.model.curves.curve_problems import (
    JOINTS,
    CurveProblem,
    Finding,
    minor_names,
    posture_problem,
    what_is_missing,
)
from robomech_ros.rvs.model.ghosts import PALETTE
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.curve_view import CurveOwner, CurveView
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext, Switch
from robomech_ros.rvs.page.tables import small_text
from robomech_ros.typing import Array

# The same pose (m, and entries of the rotation), and the same posture (rad).
SAME_POSE, SAME_POSTURE = 1e-7, 1e-4


class ContoursLayer(Layer, CurveOwner):
    """The folder with the contours of the pose that the tip is to take."""

    label, order = "Contours", 30
    root, roots = "a posture", "postures"
    hint = "Postures are where both curves cross and the other equations vanish, too"
    # Targets nearer to each other than this are drawn once.
    same = SAME_POSE

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self._view: CurveView | None = None
        self._on = False
        # Subject of the drawn curves, and the posture of the robot then.
        self._target: Array | None = None
        self._here: Array | None = None
        self._box: Any = None
        self._names, self._missing = self._named()
        if self._names:
            context.offered["contours"] = Switch(lambda: self._on, self._turn)

    def _named(self) -> tuple[tuple[str, ...], str]:
        """Name the equations, or say why there are none."""
        missing = what_is_missing(self._context.chain)
        return (() if missing else minor_names()), missing

    def _drawn(self) -> tuple[Array, Array | None]:
        """Return what to draw the curves for, and where to mark the robot in the plane."""
        arm = self._context.arm
        self._study, self._q = arm.study, arm.q
        return arm.target, (arm.q[list(JOINTS)] + np.pi) % (2.0 * np.pi) - np.pi

    # Calls of the page.

    def show(self) -> None:
        """Draw the contours of another target; nothing where they are off."""
        if self._view is None or self._view.removed or not self._on:
            return
        target, here = self._drawn()
        if self._target is None or np.abs(target - self._target).max() > self.same:
            self._target = target
            self._view.draw(here)
        elif here is not None and (self._here is None or (here != self._here).any()):
            self._view.mark_here(here)
        self._here = here

    def controls(self, client: Any) -> Controls:
        """Return the folder: a switch, or a sentence for robots that have no contours."""
        self._view, self._on, self._target = None, False, None
        folder = super().controls(client)
        return folder if self._view is None else AllControls([self._view, folder])

    def _fill(self, folder: Folder, gui: Any) -> None:
        if self._missing:
            folder.text().content = small_text([self._missing])
            return
        self._box = folder.checkbox("contours", False, self._switch, self.hint)
        self._view = CurveView(
            gui, self, self._worker.submit, self._names, (0, len(self._names) - 1)
        )
        self._view.show(False)

    def _switch(self, on: bool) -> None:
        """Switch on or off; what is shown follows by ``show``, after each request."""
        self._on, self._target = on, None
        if self._view is not None:
            self._view.show(on)

    def _turn(self, on: bool) -> None:
        # Without a commanding browser there is nothing to switch.
        if self._view is not None and not self._view.removed and on != self._on:
            self._box.value = on
            self._switch(on)

    # Calls of the view of the curves.

    def present(self, kind: Hashable, request: Callable[[], None]) -> None:
        """Do something on the thread of the page."""
        self.ask(kind, request)

    def problem(self, pair: tuple[int, int]) -> CurveProblem | None:
        """Return the contours of the pose; None where they have been switched off."""
        T = self._target
        return None if T is None else posture_problem(self._context.chain, T, pair)

    def disc(self, found: Finding) -> tuple[str, str]:
        """Return the number and the colour of a posture in the table, none outside the limits."""
        number = self._number(found)
        if number is None:
            return "", ROOT
        return str(number + 1), f"rgb{PALETTE[number % len(PALETTE)]}"

    def take(self, found: Finding) -> None:
        """Move the arm to a posture, each joint in the turn that is inside its limits."""
        if found.q is None:
            return
        number = self._number(found)
        near = self._q if number is None else self._study.postures[number].q
        turn = 2.0 * math.pi
        self._context.arm.move_to(found.q + turn * np.round((near - found.q) / turn))

    def _number(self, found: Finding) -> int | None:
        for number, posture in enumerate(self._study.postures):
            if found.q is not None:
                apart = (posture.q - found.q + np.pi) % (2.0 * np.pi) - np.pi
                if np.abs(apart).max() < SAME_POSTURE:
                    return number
        return None
