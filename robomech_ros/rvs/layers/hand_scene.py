"""An object in a hand, in the scene: its body, friction cones, and forces as arrows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.rvs.model.analysis import TwistArrows, twist_arrows
from robomech_ros.rvs.model.hands.grasp import GraspStudy
from robomech_ros.rvs.model.hands.hand_view import HandView
from robomech_ros.rvs.model.solids import cone
from robomech_ros.rvs.page.mesh_nodes import add_batch, add_mesh
from robomech_ros.rvs.page.robot_nodes import placed
from robomech_ros.rvs.page.twist_nodes import TwistNodes
from robomech_ros.spatial import quaternion_from_matrix

BODY, BODY_OPACITY = (120, 150, 190), 0.25
# Cones of fingers that touch, and of those that do not reach; and of those without friction.
CONE, FAR_CONE, CONE_OPACITY = (60, 160, 90), (150, 150, 150), 0.35
NARROWEST = 0.04
# Length of the side of a cone, and of the longest arrow, in sizes of the object.
SIDE, LONGEST = 0.35, 0.8
# Of arrows: forces of fingers, load, and what separates; each of force and of moment.
FORCE = ((20, 110, 60), (20, 110, 60))
LOAD = ((225, 120, 20), (190, 140, 60))
SEPARATING = ((225, 40, 45), (190, 50, 190))


class HandScene:
    """The nodes.

    Parameters
    ----------
    scene : viser.SceneApi
    base : str
        Node of the palm.
    reach : float
        Of the hand (m).
    """

    def __init__(self, scene: Any, base: str, reach: float) -> None:
        self._scene, self._root, self._reach = scene, base, reach
        self._body: Any = None
        self._held: object = None
        self._arrows = {
            name: TwistNodes(scene, f"{base}/{name}_", reach)
            for name in ("force", "load", "separating")
        }
        look: dict[str, Any] = {"opacity": CONE_OPACITY, "side": "double", "visible": False}
        self._cones = add_batch(scene, f"{base}/cones", cone(1.0, 1.0), **look)
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
        place = placed(hand.tip)
        self._body.position, self._body.wxyz = place["position"], place["wxyz"]
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
    centre, longest = hand.tip[:3, 3], max(_longest(hand, study), 1e-12)
    scale = LONGEST * hand.held.size / longest
    force, moment = scale * hand.load[3:], hand.load[:3]
    length = float(np.linalg.norm(moment))
    along = moment * (LONGEST * hand.held.size / length) if length > 0.0 else moment
    parts = [
        np.stack([centre, centre + way])[None] if way.any() else np.empty((0, 2, 3))
        for way in (force, along)
    ]
    return TwistArrows(*parts)
