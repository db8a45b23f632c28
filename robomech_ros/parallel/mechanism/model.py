"""The model of a parallel robot that nodes, dynamics, trajectories and the view use."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel.argument_checks import (
    actuated as checked_drives,
    platform_poses,
    single_pose,
)
from robomech_ros.parallel.mechanism.limb import (
    Limb,
    checked_limbs,
    limit_margins,
    with_drive_limits,
)
from robomech_ros.parallel.mechanism.loops import Loops
from robomech_ros.parallel.mechanism.mobility import check_drives
from robomech_ros.parallel.mechanism.motion import LoopMotion
from robomech_ros.parallel.mechanism.parts import LinkBodies, limbs_with_parts
from robomech_ros.parallel.mechanism.postures import joints_of_mode, limb_postures
from robomech_ros.parallel.mechanism.search import AssemblySearch
from robomech_ros.parallel.mechanism.shapes import shapes_of_limbs
from robomech_ros.parallel.mechanism.tree import LIMITS, tree_of_limbs
from robomech_ros.parallel.result import AssemblyModes, DirectKinematicsResult, MechanismPostures
from robomech_ros.robots import Body, RobotDescription
from robomech_ros.typing import Array, ArrayLike

# Errors (rad, m) of loops that are closed where all joints are at zero.
_CLOSED = 1e-9
# Postures whose regularity differs by no more than this part are regular alike.
_ALIKE = 1e-9


class Mechanism(LoopMotion):
    """Limbs that carry one platform: chains with actuated and passive joints, and closed loops.

    Joints are counted limb by limb, from the base to the platform.  In the tree of links the
    first limb ends at the platform; every other one ends in a link of its own, which is where the
    platform is as long as the loops are closed.

    Parameters
    ----------
    limbs : sequence of Limb
        Two or more, from the same base link.
    name : str, optional
        What it is called.
    direct : callable, optional
        Gives the poses of the platform, a DirectKinematicsResult, for positions of the drives and
        the pose nearest to which they are sorted, or None; by default they are searched.
    parts : LinkBodies, optional
        Bodies of links and platform, and what drives add to them.  Default none.
    robot : StewartGough, Delta, Planar3RPR, Planar3RRR or Spherical3RRR, optional
        The one whose limbs these are; default none.
    home_poses : array_like, shape (k, 4, 4), optional
        Poses ``T_base_platform`` (m), from which :meth:`home` takes the one furthest from singular;
        by default all joints begin at zero if the loops are closed there, else where a search
        finds them closed.

    Raises
    ------
    BadValueError, WrongSizeError
        Limbs that do not fit together, or, where no ``direct`` is given, more or fewer drives than
        the closed loops leave freedoms.

    Examples
    --------
    >>> from robomech_ros.parallel import load_parallel
    >>> mechanism = load_parallel("hexapod").mechanism
    >>> len(mechanism.joint_names), mechanism.dof, mechanism.actuated[:2]
    (36, 6, ('leg1_length', 'leg2_length'))
    """

    def __init__(
        self,
        limbs: Sequence[Limb],
        *,
        name: str = "mechanism",
        direct: Callable[[Array, Array | None], DirectKinematicsResult] | None = None,
        home_poses: ArrayLike | None = None,
        parts: LinkBodies | None = None,
        robot: Any = None,
    ) -> None:
        self.name, self.robot = name, robot
        given = checked_limbs(limbs)
        self.limbs, self.platform_body = limbs_with_parts(
            given, given[0].chain.tip, LinkBodies() if parts is None else parts
        )
        chains = [limb.chain for limb in self.limbs]
        self.base_link = chains[0].base
        self.platform_link = chains[0].tip
        self.joint_names = tuple(name for chain in chains for name in chain.joint_names)
        driven = {name for limb in self.limbs for name in limb.actuated}
        self.actuated = tuple(name for name in self.joint_names if name in driven)
        self.passive = tuple(name for name in self.joint_names if name not in driven)
        self.lower, self.upper, self.velocity, self.acceleration, self.jerk, self.effort = (
            np.concatenate([getattr(chain, limit) for chain in chains]) for limit in LIMITS
        )
        self.types = np.concatenate([chain.types for chain in chains])
        self.units = tuple(unit for chain in chains for unit in chain.units)
        # Indices of the drives among all joints.
        self.drive_index = np.flatnonzero([name in driven for name in self.joint_names])
        super().__init__(Loops.of(chains, self.drive_index), len(self.joint_names), len(driven))
        # The longest constant offset in it (m).
        self.size = self.loops.size
        # The first joints of cones, and their angles (rad).
        of_limbs = zip(self.limbs, self.loops.starts[:-1], strict=True)
        at = np.concatenate([k + limb.bent[0] for limb, k in of_limbs])
        self.bent = at, np.concatenate([limb.bent[1] for limb in self.limbs])
        self._home_poses = None if home_poses is None else platform_poses(home_poses)
        self._direct = direct or AssemblySearch(chains, self.loops)
        if direct is None:
            check_drives(chains, self.loops, self._home)

    @classmethod
    def of(cls, robot: Any, limbs: Sequence[Limb], home_poses: ArrayLike) -> Mechanism:
        """Make the model of a robot with a closed form: its limbs, and where it may begin."""
        limited = with_drive_limits(limbs, robot.drive_limits)
        given = {"name": robot.name, "direct": robot.direct, "parts": robot.parts, "robot": robot}
        return cls(limited, home_poses=home_poses, **given)

    def with_platform_body(self, body: Body) -> Mechanism:
        """Return the mechanism whose platform has another body, seen in its frame."""
        other = copy.copy(self)
        other.__dict__.pop("description", None)
        other.platform_body = body
        return other

    def with_direct(
        self, direct: Callable[[Array, Array | None], DirectKinematicsResult]
    ) -> Mechanism:
        """Return the mechanism whose poses for given drives are found in another way."""
        other = copy.copy(self)
        other._direct = direct
        return other

    @cached_property
    def family(self) -> str:
        """Number of limbs and their joints from the base on, as in ``6-PRRRRR``."""
        kinds = ["".join("RP"[kind] for kind in limb.chain.types) for limb in self.limbs]
        return " ".join(f"{kinds.count(kind)}-{kind}" for kind in dict.fromkeys(kinds))

    @property
    def mechanism(self) -> Mechanism:
        """The model itself, as every parallel robot has one."""
        return self

    @cached_property
    def description(self) -> RobotDescription:
        """The tree of links and joints, without its loops."""
        chains = [limb.chain for limb in self.limbs]
        shapes = shapes_of_limbs(chains, self._home)
        return tree_of_limbs(self.name, chains, self.platform_body, shapes)

    def urdf(self) -> str:
        """Write the tree as a URDF.

        The last link of each limb but the first has no body: it is where the platform is.
        """
        return self.description.document

    def limit_margin(self, q: ArrayLike) -> Array:
        """Say how far joints (..., n) are from their limits (rad or m), cones included.

        That is negative outside, and infinite without limits; how far a joint may still bend in its
        cone is said of the first of its two joints.
        """
        return limit_margins(self._all_joints("q", q), self, *self.bent)

    def limit_excess(self, q: ArrayLike) -> Array:
        """Say by how much joints are outside their limits and cones: 0 inside."""
        return np.maximum(-self.limit_margin(q), 0.0)

    def postures(
        self, T: ArrayLike, *, seed: ArrayLike | None = None, ignore_limits: bool = False
    ) -> MechanismPostures:
        """Find all joints that hold the platform in a pose, in all branches of all limbs.

        Parameters
        ----------
        T : array_like, shape (4, 4)
            ``T_base_platform`` (m), one that the platform can take.
        seed : array_like, shape (n,), optional
            All joints (rad or m): the nearest posture comes first.
        ignore_limits : bool, optional
            Also give postures outside the limits of joints.
        """
        pose = single_pose(T)
        near = None if seed is None else checked_drives("seed", seed, self.n)
        return limb_postures(self.limbs, pose, near, ignore_limits)

    def direct(self, actuated: ArrayLike, *, seed: ArrayLike | None = None) -> AssemblyModes:
        """Find all poses of the platform for positions of the drives, and all joints of each.

        Parameters
        ----------
        actuated : array_like, shape (m,)
            Of the drives (rad or m).
        seed : array_like, shape (4, 4) or (n,), optional
            A pose, or all joints: the nearest mode comes first.
        """
        given = checked_drives("actuated", actuated, self.dof)
        near = None
        if seed is not None:
            near = self.pose(seed) if np.shape(seed) == (self.n,) else platform_poses(seed, "seed")
        found = self._direct(given, near)
        if isinstance(found, AssemblyModes):
            return found
        rows = [joints_of_mode(self.limbs, self.loops, pose, given) for pose in found.poses]
        q = np.array(rows).reshape(-1, self.n)
        return AssemblyModes(**vars(found), q=q)

    def home(self) -> Array:
        """Return the posture (n,) to begin with: the first one furthest from singular."""
        return self._home.copy()

    def midway_postures(self, ends: Array) -> Array:
        """Return postures (k, n) half the ways from home to where the drives are at ends (k, m).

        Where the mode ends on the first half, in a singular posture, half of the part before it.
        """
        start, rows = self._home[self.drive_index], []
        for end in ends:
            way = 0.5 * (end - start)
            closed = self.close(start + way, self._home)
            if closed.status:
                closed = self.close(start + 0.5 * closed.part * way, self._home)
            rows.append(closed.q)
        return np.array(rows)

    @cached_property
    def _home(self) -> Array:
        found = list[Array]()
        if self._home_poses is None:
            zero = np.zeros(self.n)
            if self.loop_errors(zero).max() <= _CLOSED:
                return zero
            middle = np.concatenate([limb.chain.midrange() for limb in self.limbs])
            found = list(self.direct(middle[self.drive_index]).q)
        else:
            for ignore in (False, True):
                for pose in self._home_poses:
                    found += list(self.postures(pose, ignore_limits=ignore).q)
                if found:
                    break
        if not found:
            raise BadValueError("limbs", self.name, "limbs that close at their home")
        # Rounding must not choose between mirrored postures.
        regular = np.array([self._regularity(q) for q in found])
        return found[int(np.argmax(regular >= (1.0 - _ALIKE) * regular.max()))]

    def _regularity(self, q: Array) -> float:
        """Return the ratio of least to greatest singular value of the twists of the drives."""
        try:
            values = np.linalg.svd(self.scaled_twists(q), compute_uv=False)
        except BadValueError:
            return 0.0
        return float(values[-1] / values[0])

    def scaled_twists(self, q: Array) -> Array:
        """Return `twist_matrix` with lengths of platform and drives over the size."""
        twists = self.twist_matrix(q) / self.loops.weights[self.drive_index]
        twists[..., 3:, :] /= self.size
        return twists
