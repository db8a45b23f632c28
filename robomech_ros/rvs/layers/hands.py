"""A hand that holds an object: its contacts, what they hold, and with what forces."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.hands.contacts import MODELS
from robomech_ros.numerics.arrays import real_within
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.rvs.model.arms.analysis import TwistArrows, twist_arrows
from robomech_ros.rvs.model.bodies.solids import cone
from robomech_ros.rvs.model.hands.grasp import Grasp, GraspStudy, Line, quality_line, study_grasp
from robomech_ros.rvs.model.hands.hand_view import SHAPES, SPOT, HandView
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.mesh_nodes import add_batch, add_mesh
from robomech_ros.rvs.page.node_space import NodeSpace, place_node
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.twist_nodes import TwistNodes
from robomech_ros.spatial import quaternion_from_matrix
from robomech_ros.spatial.arrays import as_finite

BODY, BODY_OPACITY = (120, 150, 190), 0.25
# Cones of fingers that touch, and of those that do not reach; and of those without friction.
CONE, FAR_CONE, CONE_OPACITY = (60, 160, 90), (150, 150, 150), 0.35
NARROWEST = 0.04
# Length of the side of a cone, and of the longest arrow, in sizes of the object.
SIDE, LONGEST = 0.35, 0.8
# Colours of arrows: forces of fingers, load, and separating wrench; each of force and of moment.
FORCE = ((20, 110, 60), (20, 110, 60))
LOAD = ((225, 120, 20), (190, 140, 60))
SEPARATING = ((225, 40, 45), (190, 50, 190))
# Greatest force and moment of a load that is asked for (N, N m).
MOST_LOAD = 1000.0
# Switches, by their labels.
PARTS = ("object", "cones", "forces")
# Step of the numbers of a load.
LOAD_STEP = 0.1
SIZE_HINT = "m: radius of a ball or cylinder, half the side of a box"
MODEL_HINT = "frictionless, with friction, or soft: with a moment about the normal, too"
# Sliders from 0: greatest value, and meaning.
SHARES = {
    "friction": (2.0, "Largest tangential force as a share of the normal force"),
    "torsional": (0.1, "m: largest moment of a soft finger for 1 N of normal force"),
}
LOADS = {
    "force": (slice(3, 6), "N, on the object at its centre, in the axes of the palm"),
    "moment": (slice(0, 3), "N m, on the object about its centre, in the axes of the palm"),
}


class HandScene:
    """The nodes, in the palm."""

    def __init__(self, space: NodeSpace) -> None:
        self._scene, self._root, self._reach = space
        self._body: Any = None
        self._held: object = None
        self._arrows = {name: TwistNodes(space, name) for name in ("force", "load", "separating")}
        look: dict[str, Any] = {"opacity": CONE_OPACITY, "side": "double", "visible": False}
        self._cones = add_batch(self._scene, f"{self._root}/cones", cone(1.0, 1.0), **look)
        self._touching = False
        self._shown: dict[str, tuple[TwistArrows | None, Any]] = {}

    def draw(self, hand: HandView, study: GraspStudy) -> None:
        """Draw an object where it is, its contacts, and what holds it."""
        if hand.held != self._held:
            self._held = hand.held
            if self._body is not None:
                self._body.remove()
            look: dict[str, Any] = {"side": "double", "flat_shading": hand.held.shape != "ball"}
            name, solid = f"{self._root}/object", hand.held.solid
            self._body = add_mesh(self._scene, name, solid, BODY, BODY_OPACITY, **look)
        place_node(self._body, hand.tip)
        self._place_cones(hand)
        self._shown = {
            "force": (_forces(hand, study), FORCE),
            "load": (_load(hand, study), LOAD),
            "separating": (self._separating(hand, study), SEPARATING),
        }

    def switch(self, on: Mapping[str, bool]) -> None:
        """Show the object, the cones and the forces, or not."""
        self._body.visible = on["object"]
        self._cones.visible = on["cones"] and self._touching
        for name, (arrows, colours) in self._shown.items():
            self._arrows[name].show(arrows if on["forces"] else None, colours)

    def _place_cones(self, hand: HandView) -> None:
        """Put a cone of friction to each contact, its tip there."""
        fingers = [k for k, spot in enumerate(hand.spots) if spot.touches]
        self._touching = bool(fingers)
        if not fingers:
            return
        contacts = hand.contacts(fingers)
        friction = 0.0 if hand.model == "frictionless" else hand.friction
        height = SIDE * hand.held.size / float(np.hypot(1.0, friction))
        radius = max(friction * height, NARROWEST * hand.held.size)
        turns = np.array([rotation_from_z(one.normal)[:3, :3] for one in contacts])
        colours = [CONE if k in hand.reached else FAR_CONE for k in fingers]
        cones = self._cones
        cones.batched_positions = np.array([one.position for one in contacts], dtype=np.float32)
        cones.batched_wxyzs = np.roll(quaternion_from_matrix(turns), 1, axis=-1).astype(np.float32)
        scales = np.tile((radius, radius, height), (len(fingers), 1))
        cones.batched_scales = scales.astype(np.float32)
        cones.batched_colors = np.array(colours, dtype=np.uint8)

    def _separating(self, hand: HandView, study: GraspStudy) -> TwistArrows | None:
        if study.separating is None:
            return None
        return twist_arrows(hand.tip[:3, 3], study.separating[None], self._reach)


def _longest(hand: HandView, study: GraspStudy) -> float:
    """Return the greatest of the forces on the object (N)."""
    return float(np.linalg.norm(np.vstack([study.forces, hand.load[None, 3:]]), axis=1).max())


def _forces(hand: HandView, study: GraspStudy) -> TwistArrows | None:
    if not len(study.forces):
        return None
    scale = LONGEST * hand.held.size / _longest(hand, study)
    starts = np.array([one.position for one in hand.contacts(hand.reached)])
    ends = np.stack([starts, starts + scale * study.forces], axis=1)
    seen = np.linalg.norm(study.forces, axis=1) > 0.0
    return TwistArrows(ends[seen], np.empty((0, 2, 3)))


def _load(hand: HandView, study: GraspStudy) -> TwistArrows:
    """Draw the load, from the centre of the object: force, and moment over the size."""
    centre, size, moment = hand.tip[:3, 3], LONGEST * hand.held.size, hand.load[:3]
    force = size / max(_longest(hand, study), 1e-12) * hand.load[3:]
    along = size / max(float(np.linalg.norm(moment)), 1e-300) * moment
    parts = [
        np.stack([centre, centre + vector])[None] if vector.any() else np.empty((0, 2, 3))
        for vector in (force, along)
    ]
    return TwistArrows(*parts)


class HandLayer(Layer):
    """The layer; the quality is found on a thread of its own, and of each grasp the latest."""

    label, order, expanded = "Grasp", 3.5, True

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self.hand = context.robot_of(HandView)
        self._scene = HandScene(context.space)
        self.on = dict.fromkeys(PARTS, True)
        self._studied: object = None
        self._lines: tuple[Line, ...] = ()
        self._separates = False
        self._quality: Line = ("quality", "looking ...")
        self._switches = Switches(context, {part: part for part in PARTS}, self.on)
        self.show()

    def show(self) -> None:
        """Follow the hand and its object."""
        grasp, now = self.hand.grasp, self.hand.state
        if now != self._studied:
            self._studied = now
            study = study_grasp(grasp)
            self._lines, self._separates = study.lines, study.separating is not None
            self._quality = ("quality", "looking ...")
            self._scene.draw(self.hand, study)
            self.find("quality", partial(_quality, grasp), partial(self._know, now))
        self._scene.switch(self.on)
        closure, *rest = self._lines
        self.write("grasp", [closure, self._quality, *rest, *self._legend()])

    def controls(self, client: Any) -> Controls:
        """Add the folders "Grasp" and "Contacts" to a browser."""
        grasp = super().controls(client)
        self._contacts = self._add_folder(client.gui, "Contacts", self.order + 0.1)
        with self._contacts:
            for k, name in enumerate(self.hand.hand.finger_names):
                self._add_spot(self._contacts, k, name)
        return AllControls([grasp, self._contacts])

    def _fill(self, folder: Folder, gui: Any) -> None:
        hand, choose = self.hand, self._choose_contact
        self._table = folder.text()
        folder.dropdown("shape", SHAPES, hand.held.shape, self._choose_shape)
        folder.slider("size", "m", hand.sizes, hand.held.size, self._choose_size, SIZE_HINT)
        folder.dropdown("contacts", MODELS, hand.model, partial(choose, "model"), MODEL_HINT)
        for name, (most, hint) in SHARES.items():
            folder.slider(name, "", (0.0, most), getattr(hand, name), partial(choose, name), hint)
        for name, (rows, hint) in LOADS.items():
            field = gui.add_vector3(name, hand.load[rows].tolist(), step=LOAD_STEP, hint=hint)
            folder.listen(field, partial(self.ask, name, self._choose_load, name))
        for part in self.on:
            self._switches.add_to(folder, part)

    def _add_spot(self, folder: Folder, finger: int, name: str) -> None:
        spot, choose = self.hand.spots[finger], partial(self._choose_spot, finger)
        folder.checkbox(f"{name} touches", spot.touches, partial(choose, "touches"))
        for what, (low, high, unit) in SPOT.items():
            value, change = getattr(spot, what), partial(choose, what)
            folder.slider(f"{name} {what}", unit, (low, high), value, change)

    # Requests of browsers, on the thread of the page.

    def _choose_shape(self, value: Any) -> None:
        self.hand.held = replace(self.hand.held, shape=value)
        self.hand.touch()

    def _choose_size(self, value: Any) -> None:
        size = _between("size", value, (*self.hand.sizes, "m"))
        self.hand.held = replace(self.hand.held, size=size)
        self.hand.touch()

    def _choose_contact(self, name: str, value: Any) -> None:
        hand = self.hand
        given = {"model": hand.model, "friction": hand.friction, "torsional": hand.torsional}
        contact = replace(hand.contact(0), **{**given, name: value})
        setattr(hand, name, getattr(contact, name))
        hand.touch()

    def _choose_load(self, name: str, value: Any) -> None:
        """Change the "force" (N) or the "moment" (N m) of the load."""
        given = as_finite(name, value, (3,))
        if given.shape != (3,) or np.abs(given).max() > MOST_LOAD:
            raise BadValueError(name, value, f"three numbers up to {MOST_LOAD:g}")
        self.hand.load[LOADS[name][0]] = given

    def _choose_spot(self, finger: int, name: str, value: Any) -> None:
        new: Any = value if name == "touches" else _between(name, value, SPOT[name])
        self.hand.spots[finger] = replace(self.hand.spots[finger], **{name: new})
        self.hand.touch()

    # Internal steps.

    def _know(self, key: object, line: Line) -> None:
        if key == self._studied:
            self._quality = line

    def _legend(self) -> list[Line]:
        if not self.on["forces"]:
            return []
        if self._separates:
            return [("arrows", "orange: the load; red along, purple about: what is not held")]
        return [("arrows", "green: what fingers exert; orange: the load")]


def _quality(grasp: Grasp) -> Line:
    try:
        return quality_line(grasp)
    except RobomechError as error:
        return ("quality", str(error))


def _between(what: str, value: Any, travel: tuple[float, float, str]) -> float:
    low, high, unit = travel
    return real_within(what, value, f"{low:g} to {high:g} {unit}", low, high)
