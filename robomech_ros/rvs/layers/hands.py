"""A hand that holds an object: its contacts, what they hold, and with what forces."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.rvs.layers.hand_controls import LOADS, HandControls
from robomech_ros.rvs.layers.hand_scene import HandScene
from robomech_ros.rvs.model.hands.grasp import Grasp, Line, quality_line, study_grasp
from robomech_ros.rvs.model.hands.grasped_object import SHAPES
from robomech_ros.rvs.model.hands.hand_view import SPOT, HandView
from robomech_ros.rvs.page.clients import Controls
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.serving.worker import Worker
from robomech_ros.spatial.arrays import as_choice, as_finite, as_flag

# Greatest force and moment of a load that is asked for (N, N m).
MOST_LOAD = 1000.0
# What can be shown, by its label.
PARTS = ("object", "cones", "forces")


class HandLayer:
    """The layer; the quality is found on a thread of its own, and of each grasp the latest.

    Parameters
    ----------
    place : LayerContext
    """

    def __init__(self, place: LayerContext) -> None:
        if not isinstance(place.moved, HandView):
            raise TypeError("the page shows no hand")
        self._place, self.hand = place, place.moved
        self._worker = Worker()
        self._scene = HandScene(place.server.scene, place.base, place.seen.reach)
        self.on = dict.fromkeys(PARTS, True)
        self._studied: object = None
        self._lines: tuple[Line, ...] = ()
        self._separates = False
        self._quality: Line = ("quality", "looking ...")
        self._controls: HandControls | None = None
        self.switches = Switches(place, {part: part for part in PARTS}, self.on)
        self.show()

    def show(self) -> None:
        """Follow the hand and its object."""
        grasp = self.hand.grasp
        now = self.hand.state
        if now != self._studied:
            self._studied = now
            study = study_grasp(grasp)
            self._lines, self._separates = study.lines, study.separating is not None
            self._quality = ("quality", "looking ...")
            self._scene.draw(self.hand, study)
            self._worker.submit("quality", lambda: self._find(grasp, now))
        self._scene.switch(self.on)
        self._write()

    def controls(self, client: Any) -> Controls:
        """Give a browser the folders "Grasp" and "Contacts"."""
        self._controls = HandControls(client.gui, self._place.units, self)
        self.show()
        return self._controls

    def close(self) -> None:
        """Stop what runs."""
        self._worker.close(wait=False)

    # What the controls ask for; each returns at once.

    def choose_shape(self, value: Any) -> None:
        """Let the fingers touch an object of another shape."""

        def chosen() -> None:
            self.hand.held = replace(self.hand.held, shape=as_choice("object", value, SHAPES))
            self.hand.touch()

        self._place.ask((self, "shape"), chosen)

    def choose_size(self, value: Any) -> None:
        """Let the fingers touch a larger or smaller object (m)."""

        def chosen() -> None:
            size = _between("size", value, (*self.hand.sizes, "m"))
            self.hand.held = replace(self.hand.held, size=size)
            self.hand.touch()

        self._place.ask((self, "size"), chosen, "size")

    def choose_contact(self, name: str, value: Any) -> None:
        """Change the model of contacts, or a number of it."""

        def chosen() -> None:
            hand = self.hand
            given = {"model": hand.model, "friction": hand.friction, "torsional": hand.torsional}
            contact = replace(hand.contact(0), **{**given, name: value})
            setattr(hand, name, getattr(contact, name))
            hand.touch()

        self._place.ask((self, name), chosen, name)

    def choose_load(self, name: str, value: Any) -> None:
        """Change the "force" (N) or the "moment" (N m) of the load."""

        def chosen() -> None:
            given = as_finite(name, value, (3,))
            if given.shape != (3,) or np.abs(given).max() > MOST_LOAD:
                raise BadValueError(name, value, f"three numbers up to {MOST_LOAD:g}")
            self.hand.load[LOADS[name][0]] = given

        self._place.ask((self, name), chosen)

    def choose_spot(self, finger: int, name: str, value: Any) -> None:
        """Change whether and where a finger touches."""

        def chosen() -> None:
            spot = self.hand.spots[finger]
            if name == "touches":
                spot = replace(spot, touches=as_flag(name, value))
            else:
                number = _between(name, value, SPOT[name])
                spot = (
                    replace(spot, angle=number) if name == "angle" else replace(spot, height=number)
                )
            self.hand.spots[finger] = spot
            self.hand.touch()

        self._place.ask((self, finger, name), chosen, (finger, name))

    # What happens inside.

    def _find(self, grasp: Grasp, key: object) -> None:
        """Find the quality, on the thread of the layer."""
        try:
            line = quality_line(grasp)
        except RobomechError as error:
            line = ("quality", str(error))

        def known() -> None:
            if key == self._studied:
                self._quality = line

        self._place.ask((self, "quality"), known)

    def _write(self) -> None:
        if self._controls is not None:
            closure, *rest = self._lines
            self._controls.write([closure, self._quality, *rest, *self._legend()])

    def _legend(self) -> list[Line]:
        """Say what the arrows are."""
        if not self.on["forces"]:
            return []
        if self._separates:
            return [("arrows", "orange: the load; red along, purple about: what is not held")]
        return [("arrows", "green: what fingers exert; orange: the load")]


def _between(what: str, value: Any, travel: tuple[float, float, str]) -> float:
    """Check a number between two others, of a unit."""
    low, high, unit = travel
    given = finite_number(what, value, unit)
    if not low <= given <= high:
        raise BadValueError(what, value, f"{low:g} to {high:g} {unit}")
    return given
