"""A robot, the objects around it, and how near it comes to them and to itself."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from copy import copy
from dataclasses import replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from robomech_ros.collision.distances import Clearance, Distances, checked_clearance
from robomech_ros.collision.motion_proof import MotionCheck, check_motion
from robomech_ros.collision.placed_bodies import (
    PlacedBody,
    place_bodies,
    place_objects,
    reason_to_ignore,
)
from robomech_ros.collision.planning import PathPlan, PlanRequest, plan_path
from robomech_ros.collision.robot_bodies import link_bodies, place_links, pose_of_link
from robomech_ros.collision.scene_objects import (
    SceneObject,
    Shapes,
    as_object_pose,
    carried_by,
    read_parts,
)
from robomech_ros.collision.scene_robot import chain_of, ignored_links, touching_pairs
from robomech_ros.errors import BadValueError, UnknownLinkError
from robomech_ros.kinematics.joint_values import as_finite_values
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.entry_checks import bare_link, check_name
from robomech_ros.robots.semantic import SemanticDescription
from robomech_ros.spatial import inverse_pose
from robomech_ros.spatial.arrays import finite_within, listed
from robomech_ros.typing import Array, BoolArray

LARGEST_PADDING = 1.0


class PlanningScene:
    """A robot and the objects around it.

    Links of robots without collision elements in their URDF are not checked, and neither are those
    whose meshes cannot be read: see `has_geometry` and `unchecked`.  A closed mesh of a link that
    is not convex is covered by convex parts; the hull stands for an open or small one.

    Parameters
    ----------
    robot : SerialChain, RobotDescription, str or path
        A chain, or the source of one (see `load_robot`).
    base, tip : str, optional
        Ends of the chain, unless the robot is one.  All poses are in the base.
    srdf : SemanticDescription, str or path, optional
        Its disabled pairs of links are not checked.
    padding : float
        Enlargement of links against objects (m).

    Raises
    ------
    MissingLibraryError
        coal is not installed.

    Examples
    --------
    >>> from robomech_ros.collision import Box, PlanningScene
    >>> scene = PlanningScene("ur5e")
    >>> scene.add("table", Box(1.0, 1.0, 0.1))
    >>> scene.bodies, scene.has_geometry
    (('table',), False)
    """

    def __init__(
        self,
        robot: SerialChain | RobotDescription | str | os.PathLike[str],
        *,
        base: str | None = None,
        tip: str | None = None,
        srdf: SemanticDescription | str | os.PathLike[str] | None = None,
        padding: float = 0.0,
    ) -> None:
        self.chain = chain_of(robot, base, tip)
        expected = f"0 to {LARGEST_PADDING:g} m"
        self.padding = finite_within("padding", padding, expected, 0.0, LARGEST_PADDING)
        self._objects: dict[str, SceneObject] = {}
        self._known_bounds: dict[bytes, Array] = {}
        self._links, self.unchecked = link_bodies(self.chain.description)
        self._place_links({})
        with_shapes = {link for link, *_ in self._links}
        self._allowed = ignored_links(self.chain.description, srdf, with_shapes)
        self._allowed.update(touching_pairs(self.chain, self.distances))
        self._changed()

    def copy(self) -> PlanningScene:
        """Return an independent scene of the same robot and objects."""
        other = copy(self)
        other._others, other._objects = dict(self._others), dict(self._objects)
        other._allowed = dict(self._allowed)
        other.__dict__.pop("distances", None)
        return other

    @property
    def has_geometry(self) -> bool:
        """True if any link of the robot has a shape; without one nothing is checked."""
        return bool(self._links)

    @property
    def unchecked_text(self) -> str:
        """Unchecked links, with the reasons; empty if all links are checked."""
        if not self.has_geometry:
            description = self.chain.description
            name = self.chain.name if description is None else description.name
            return f"no collisions were checked: '{name}' has no collision geometry"
        faults = "; ".join(f"link '{link}': {why}" for link, why in self.unchecked.items())
        return f"collisions of some links were not checked: {faults}" if faults else ""

    @property
    def bodies(self) -> tuple[str, ...]:
        """Links with shapes, then objects."""
        return (*dict.fromkeys(link for link, *_ in self._links), *self._objects)

    @property
    def objects(self) -> Mapping[str, SceneObject]:
        """Objects by name, attached ones included."""
        return dict(self._objects)

    @property
    def ignored(self) -> dict[tuple[str, str], str]:
        """Reason for each pair of bodies that is not checked."""
        pairs = {pair: self._reason(*pair) for pair in combinations(self.bodies, 2)}
        return {pair: why for pair, why in pairs.items() if why}

    def add(
        self,
        name: str,
        shape: Shapes,
        pose: npt.ArrayLike | None = None,
        *,
        frame: str | None = None,
    ) -> None:
        """Add an object to the world.

        Parameters
        ----------
        name : str
            Not the name of a link or of another object.
        shape : Shape or sequence of (Shape, pose)
            One shape, or several and their poses (4, 4) in the object (m).
        pose : array_like, shape (4, 4), optional
            Pose in the frame (m), by default the identity.
        frame : str, optional
            A link, by default the base of the chain.  A link that the chain moves carries the
            object from now on, as after `attach`.
        """
        check_name("name", name)
        if name in self._objects or name in self._places.links:
            raise BadValueError("name of an object", name, "one that nothing has yet")
        placed = np.eye(4) if pose is None else as_object_pose(pose)
        link = self._known(frame) if frame else ""
        if link and not self._places.links[link].frame:
            placed, link = self._places.links[link].pose @ placed, ""
        added = SceneObject(name, read_parts(shape), placed)
        self._change({**self._objects, name: carried_by(link, added) if link else added})

    def move(self, name: str, pose: npt.ArrayLike) -> None:
        """Move an object to a pose (4, 4) in the base, or in the link that carries it (m)."""
        moved = replace(self._object(name), pose=as_object_pose(pose))
        self._change({**self._objects, name: moved})

    def remove(self, name: str) -> None:
        """Remove an object."""
        self._object(name)
        self._change({key: one for key, one in self._objects.items() if key != name})

    def attach(
        self,
        name: str,
        link: str,
        touch_links: Iterable[str] = (),
        *,
        pose: npt.ArrayLike | None = None,
        q: npt.ArrayLike | None = None,
    ) -> None:
        """Attach an object to a link.

        Parameters
        ----------
        name : str
            An object of the scene.
        link : str
        touch_links : iterable of str
            Links besides this one that may touch it, such as the fingers.
        pose : array_like, shape (4, 4), optional
            Pose of the object in the link (m).
        q : array_like, shape (n,), optional
            Posture (rad or m) at which the object keeps its pose in the base.  Without q and
            pose, the present pose of the object counts as one in the link.
        """
        found = self._object(name)
        carried = carried_by(self._known(link), found)
        links = listed("touch_links", touch_links, "names of links")
        touching = frozenset(map(self._known, links))
        placed = found.pose if pose is None else as_object_pose(pose)
        if pose is None and q is not None:
            placed = inverse_pose(self.link_pose(link, q)) @ found.pose
        attached = replace(carried, pose=placed, touch_links=touching)
        self._change({**self._objects, name: attached})

    def detach(self, name: str, *, q: npt.ArrayLike | None = None) -> None:
        """Release an object where it is at posture q (n,), or with its pose unchanged."""
        found = self._object(name)
        if not found.link:
            raise BadValueError("object", name, "one that a link carries")
        pose = found.pose if q is None else self.link_pose(found.link, q) @ found.pose
        released = replace(found, pose=pose, link="", touch_links=frozenset(), covers=())
        self._change({**self._objects, name: released})

    def allow(self, first: str, second: str, why: str = "allowed") -> None:
        """Allow two bodies to touch, links or objects."""
        known = {*self._places.links, *self._objects}
        for name in (first, second):
            if name not in known:
                raise BadValueError("body", name, f"one of {', '.join(self.bodies)}, or a link")
        self._allowed[frozenset((first, second))] = why
        self._changed()

    def forbid(self, first: str, second: str) -> None:
        """Check two bodies again that were allowed to touch."""
        self._allowed.pop(frozenset((first, second)), None)
        self._changed()

    def set_other_joints(self, positions: Mapping[str, float]) -> None:
        """Set the values of joints outside the chain, such as those of fingers (rad, m)."""
        own = [name for name in positions if name in self.chain.joint_names]
        if own:
            raise BadValueError("joint", own[0], "one that is none of the chain")
        self._place_links({**self._others, **positions})
        self._changed()

    def _place_links(self, others: dict[str, float]) -> None:
        self._places = place_links(self.chain, others)
        self._placed = list(place_bodies(self._links, self._places.links))
        self._others = others

    def load(self, scene: Mapping[str, Any] | str | os.PathLike[str]) -> None:
        """Add a scene of MoveIt, from a file or a mapping in its layout, as a whole or not at all.

        Sections: ``world.collision_objects``, ``robot_state.attached_collision_objects`` and
        ``allowed_collision_matrix``; each may be missing.
        """
        from robomech_ros.collision.scene_files import load_scene

        loaded = self.copy()
        load_scene(loaded, scene)
        self._objects, self._allowed = loaded._objects, loaded._allowed
        self._changed()

    def link_pose(self, link: str, q: npt.ArrayLike) -> Array:
        """Return the pose (4, 4) of a link in the base at q (n,) (m)."""
        return pose_of_link(self._places, self._known(link), as_finite_values(self.chain, q))

    def clearance(self, q: npt.ArrayLike) -> Clearance:
        """Find the least distance between bodies that may not touch.

        Parameters
        ----------
        q : array_like, shape (n,) or (m, n)
            Joint values (rad or m).

        Returns
        -------
        Clearance
            For a batch: distances (m,), a list of pairs of names, points (m, 2, 3).
        """
        rows, distances = as_finite_values(self.chain, q), self.distances
        return distances.nearest(rows) if rows.ndim == 1 else distances.nearest_in_batch(rows)

    def is_free(self, q: npt.ArrayLike, *, clearance: float = 0.0) -> bool | BoolArray:
        """Return whether all bodies are farther apart than a clearance (m).

        Parameters
        ----------
        q : array_like, shape (n,) or (m, n)
            Joint values (rad or m); a batch gives an array of bool.
        clearance : float
            m.
        """
        rows, least = as_finite_values(self.chain, q), checked_clearance(clearance)
        if rows.ndim == 1:
            return self.distances.contact(rows, least) is None
        flat = rows.reshape(-1, self.chain.n)
        free = [self.distances.contact(row, least) is None for row in flat]
        return np.array(free, dtype=bool).reshape(rows.shape[:-1])

    def check_motion(self, motion: Any, *, clearance: float = 0.0) -> MotionCheck:
        """Prove that a motion is free of contact, between its samples too.

        Parameters
        ----------
        motion : array_like, shape (m, n), or path or trajectory
            Waypoints joined by straight lines in joint space (rad or m), a joint path, a
            trajectory, its samples, or a piecewise polynomial.
        clearance : float
            Distance that bodies must exceed (m).

        Returns
        -------
        MotionCheck
            Free and certified, or the first contact.  Bodies that pass each other by less than
            a hundredth of a millimetre may give neither contact nor proof.
        """
        return check_motion(self.chain, self.distances, motion, checked_clearance(clearance))

    def plan(
        self,
        start: npt.ArrayLike,
        goals: npt.ArrayLike,
        *,
        timeout: float = 5.0,
        seed: int = 0,
        clearance: float = 0.0,
        planner: str = "RRTConnect",
    ) -> PathPlan:
        """Plan a path around all obstacles, every piece of it proved free of contact.

        The same request gives the same path, unless time runs out.

        Parameters
        ----------
        start : array_like, shape (n,)
            Joint values (rad or m).  A plan may leave a start in contact while the distance
            grows.  A joint outside its limits by rounding, at most 1e-5, starts at the limit.
        goals : array_like, shape (n,), (k, n) or (4, 4)
            One posture, alternative postures, or a pose of the tip (m), for which any of its
            postures is a goal.
        timeout : float
            s.
        seed : int
            Seed of the random samples.
        clearance : float
            Distance that bodies must exceed (m).
        planner : str
            A planner of OMPL out of `PLANNERS`.

        Raises
        ------
        MissingLibraryError
            OMPL is not installed.
        """
        request = PlanRequest(timeout, seed, checked_clearance(clearance), planner)
        return plan_path(self, start, goals, request)

    @cached_property
    def distances(self) -> Distances:
        """Distances of all checked pairs of the present scene."""
        placed = [*self._placed, *place_objects(self._objects.values(), self._places.links)]

        def checked(first: PlacedBody, second: PlacedBody) -> bool:
            return first.owner != second.owner and not self._reason(first.owner, second.owner)

        return Distances(self._places.joints, placed, checked, self.padding, self._known_bounds)

    def _reason(self, first: str, second: str) -> str:
        """Return the reason why two bodies are not checked; empty if they are."""
        allowed = self._allowed.get(frozenset((first, second)))
        return allowed or reason_to_ignore(first, second, self._objects, self._places.links)

    def _change(self, objects: dict[str, SceneObject]) -> None:
        self._objects = objects
        self._changed()

    def _changed(self) -> None:
        self.__dict__.pop("distances", None)

    def _object(self, name: str) -> SceneObject:
        if name not in self._objects:
            known = ", ".join(self._objects) or "none, since there are none"
            raise BadValueError("name of an object", name, f"one of {known}")
        return self._objects[name]

    def _known(self, link: str) -> str:
        check_name("link", link)
        if bare_link(link) not in self._places.links:
            raise UnknownLinkError(bare_link(link), self._places.links)
        return bare_link(link)
