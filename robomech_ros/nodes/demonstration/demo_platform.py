"""Demonstration with a parallel robot: pick, place, and a circle with a tilt."""

import numpy as np

from robomech_ros.cartesian import waypoint_path
from robomech_ros.cartesian.waypoint_paths import PathKind
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.demonstration.postures import NoPostureError
from robomech_ros.nodes.demonstration.report import TipPath
from robomech_ros.parallel import Mechanism, follow_drives, plan_platform
from robomech_ros.spatial import matrix_from_rotation_vector
from robomech_ros.typing import Array

# How many postures are tried: moves from home (parts of the size) and turns (rad) up to these, as
# far as the drives go by no more than a part of what is left of their range.
_CANDIDATES, _MOVE, _TURN, _USED_PART = 60, 0.3, 0.1, 0.5
# No posture on the way is conditioned worse, and pick and place are apart by this part of what is
# possible.
_CONDITION, _SEPARATION = 30.0, 0.5
# Points of a way of the drives that are looked at.
_SAMPLES = 20
# Lifts, radii (parts of the size) and tilts (rad) that are tried, the largest first.
_LIFTS, _RADII, _TILTS = (0.1, 0.05, 0.025), (0.12, 0.08, 0.04), (0.15, 0.1, 0.05, 0.0)
# The part of the circle that is gone (rad), in so many waypoints.
_CIRCLE_ANGLE, _WAYPOINTS = np.radians(300.0), 10


class DemoPlatform:
    """A parallel robot; the same poses every time.

    - ``mechanism``: mechanism of n joints.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.model = mechanism
        self.name, self.base = mechanism.name, mechanism.base_link
        self.joint_names, self.units = mechanism.joint_names, mechanism.units
        self.shown = mechanism.drive_index.tolist()
        limbs, n, m = len(mechanism.limbs), mechanism.n, mechanism.dof
        self.title = (
            f"{mechanism.name}: {limbs} limbs, {n} joints, {m} of them driven, "
            f"{mechanism.base_link} to {mechanism.platform_link}"
        )
        self._place = mechanism.home()

    def pose(self, q: Array) -> Array:
        """Pose of the platform in the base (4, 4), of joints (n,)."""
        return self.model.pose(q)

    def targets(self) -> tuple[Array, Array]:
        """Find free poses (4, 4) for pick and place, or raise NoPostureError."""
        ends = self._ends()
        if not len(ends):
            raise NoPostureError(f"the platform of '{self.name}' goes nowhere")
        pick = ends[0]
        T = self.pose(np.stack(ends))
        turned = self.model.size * np.linalg.norm(T[:, :3, :3] - T[0, :3, :3], axis=(1, 2))
        apart = np.linalg.norm(T[:, :3, 3] - T[0, :3, 3], axis=1) + turned
        far = [q for q, d in zip(ends, apart, strict=True) if d >= _SEPARATION * apart.max()]
        self._place = next((q for q in far if self._free(pick, q) is not None), pick)
        return self.pose(pick), self.pose(self._place)

    def _ends(self) -> list[Array]:
        """Find postures (n,) to which the drives can go straight from home."""
        robot, home = self.model, self.model.home()
        drives = robot.drive_index
        rng = np.random.default_rng(1)
        most = np.repeat([_TURN, _MOVE * robot.size], 3)
        twists = rng.uniform(-most, most, (_CANDIDATES, 6))
        moves = twists @ np.linalg.pinv(robot.twist_matrix(home)).T
        below = _USED_PART * (robot.lower - home)[drives]
        above = _USED_PART * (robot.upper - home)[drives]
        goals = home[drives] + np.clip(moves, below, above)
        return [q for goal in goals if (q := self._free(home, goal)) is not None]

    def _free(self, start: Array, goal: Array) -> Array | None:
        """Return the posture at the end of a straight path of the drives; None if one ends it."""
        drives = self.model.drive_index
        end = goal[drives] if len(goal) == self.model.n else goal
        path = np.linspace(start[drives], end, _SAMPLES)
        found = follow_drives(self.model, path, start, condition=_CONDITION)
        return None if found.stop is not None else found.q[-1]

    def path_to_place(self, pick: Array, place: Array) -> TipPath | None:
        """Lift, go over to the place, and put down, in straight lines; None if that cannot be."""
        start = self.model.postures(pick, seed=self.model.home()).q[0]
        for lift in _LIFTS:
            up = np.array([0.0, 0.0, lift * self.model.size])
            waypoints = np.stack([pick, place, place])
            waypoints[:2, :3, 3] += up
            if self._possible(start, waypoints, "straight"):
                return TipPath("place", "STRAIGHT", waypoints)
        return None

    def path_onward(self, place: Array) -> TipPath | None:
        """Return a circle that begins at place, as in machining; with a tilt if it can turn so."""
        angles = np.linspace(0.0, _CIRCLE_ANGLE, _WAYPOINTS + 1)[1:]
        # Its middle is where home is, seen from the place: there is most room.
        inwards = self.pose(self.model.home())[:2, 3] - place[:2, 3]
        far = float(np.linalg.norm(inwards))
        x, y = inwards / far if far > 0.0 else (1.0, 0.0)
        about = np.stack([1.0 - np.cos(angles), np.sin(angles)], axis=1) @ [[x, y], [-y, x]]
        round_about = np.pad(about, ((0, 0), (0, 1)))
        for tilt in _TILTS:
            for radius in _RADII:
                waypoints = np.tile(place, (_WAYPOINTS, 1, 1))
                waypoints[:, :3, 3] += radius * self.model.size * round_about
                turns = matrix_from_rotation_vector(tilt * round_about)
                waypoints[:, :3, :3] = turns @ place[:3, :3]
                if self._possible(self._place, waypoints, "spline"):
                    return TipPath("circle with tilt" if tilt else "circle", "SPLINE", waypoints)
        return None

    def _possible(self, start: Array, waypoints: Array, kind: PathKind) -> bool:
        try:
            path = waypoint_path(self.pose(start), waypoints, kind)
            return path is not None and plan_platform(self.model, path, start).stop is None
        except BadValueError:  # the platform does not move so
            return False
