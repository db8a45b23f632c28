"""A legged robot: a trunk, and legs whose feet are points."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.walking.gait_step import MOST_LEGS
from robomech_ros._kernels.walking.planted import ZERO, planted_legs
from robomech_ros.dynamics.checked_states import as_vector
from robomech_ros.errors import BadValueError, SeedOutsideLimitsError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics import InverseKinematicsResult, forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.parallel import Mechanism
from robomech_ros.robots import Body, RobotDescription, SerialChain
from robomech_ros.spatial.arrays import as_choice, as_single, check_kind, listed, whole_number
from robomech_ros.typing import Array, ArrayLike, BoolArray
from robomech_ros.walking.leg_tree import JOINTS, check_legs, one_body, rest_of_tree, tree_of_legs
from robomech_ros.walking.stance_mechanism import contact_rows, stance_mechanism

_PLACE = (True, True, True, False, False, False)
_STILL = np.zeros(0)
_planted_legs = direct(planted_legs)


class LeggedRobot:
    """A trunk with legs of three joints each; feet are points at the ends of the legs.

    Joints are counted leg by leg, each from trunk to foot.

    Parameters
    ----------
    legs : mapping of str to SerialChain
        The legs by name, each a chain from the trunk to its foot.  Gaits want the left legs from
        front to rear, then the right ones; of four legs front left, front right, rear left, rear
        right.
    home : array_like, shape (3 k,), optional
        The joints of the robot that stands to begin with (rad or m); default those of the chains.
    mass_centre : array_like, shape (3,), optional
        In the trunk (m), the legs counted as they are at home.  Default that of the masses in
        ``tree``, or else the origin of the trunk.
    name : str, optional
        What it is called.
    source : str, optional
        Where the numbers come from.
    tree : RobotDescription, optional
        The URDF that the legs were taken from.
    trunk_body : Body, optional
        Body of the trunk with everything fixed to it, in its frame.  Default all links of ``tree``
        except the legs, other joints at home.

    Raises
    ------
    SeedOutsideLimitsError, BadValueError, WrongSizeError
        Fewer than 3 or more than 16 legs, one without three joints, trunks that differ, a joint of
        ``home`` outside its limits.

    Examples
    --------
    >>> from robomech_ros.walking import load_legged
    >>> robot = load_legged("phantomx")
    >>> robot.leg_names, robot.n
    (('LF', 'LM', 'LR', 'RF', 'RM', 'RR'), 18)
    """

    def __init__(
        self,
        legs: Mapping[str, SerialChain],
        *,
        home: ArrayLike | None = None,
        mass_centre: ArrayLike | None = None,
        name: str = "legged",
        source: str = "",
        tree: RobotDescription | None = None,
        trunk_body: Body | None = None,
    ) -> None:
        check_legs(legs)
        check_kind("tree", tree, RobotDescription | None, "a RobotDescription")
        self.name, self.source, self._tree = name, source, tree
        self.leg_names, self.legs = tuple(legs), tuple(legs.values())
        self.trunk = self.legs[0].base
        self.joint_names = tuple(joint for leg in self.legs for joint in leg.joint_names)
        if len(set(self.joint_names)) < len(self.joint_names):
            raise BadValueError("joint names of the legs", self.joint_names, "different ones")
        self.lower = np.concatenate([leg.lower for leg in self.legs])
        self.upper = np.concatenate([leg.upper for leg in self.legs])
        self.velocity = np.concatenate([leg.velocity for leg in self.legs])
        self.effort = np.concatenate([leg.effort for leg in self.legs])
        # Alike for all legs where nothing is given.
        own = [leg.midrange() if leg.home_given is None else leg.home() for leg in self.legs]
        self.home = np.concatenate(own) if home is None else self.joints(home, "home").flatten()
        for joint, value, lower, upper in zip(
            self.joint_names, self.home, self.lower, self.upper, strict=True
        ):
            if not lower <= value <= upper:
                raise SeedOutsideLimitsError(joint, value, lower, upper, "home")
        check_kind("trunk_body", trunk_body, Body | None, "a Body")
        self.trunk_body = trunk_body
        if tree is not None and trunk_body is None:
            self.trunk_body = rest_of_tree(self.description, self.legs)
        if mass_centre is None and tree is not None:
            whole = one_body(self.description, self.trunk, tree.bodies)
            mass_centre = None if whole is None else whole.com
        centre = np.zeros(3) if mass_centre is None else mass_centre
        self.mass_centre = as_single("mass_centre", centre, (3,)).copy()

    @property
    def n(self) -> int:
        """Number of joints."""
        return JOINTS * len(self.legs)

    @property
    def units(self) -> tuple[str, ...]:
        """``"rad"`` or ``"m"`` for each joint."""
        return tuple(unit for leg in self.legs for unit in leg.units)

    @property
    def continuous(self) -> BoolArray:
        """Mask (3 k,) of joints that turn without limits."""
        return np.concatenate([leg.continuous for leg in self.legs])

    @cached_property
    def description(self) -> RobotDescription:
        """The tree of links and joints at home: the URDF of the legs, or a generated one."""
        tree = self._tree
        if tree is None:
            tree = tree_of_legs(self.name, self.source, self.legs, self.trunk_body)
        home = dict(zip(self.joint_names, self.home.tolist(), strict=True))
        return replace(tree, home={**tree.home, **home})

    @cached_property
    def packed(self) -> Array:
        """The legs as kernels read them, shape (k, 4, 13)."""
        return np.array([leg.packed for leg in self.legs])

    @classmethod
    def from_description(
        cls,
        description: RobotDescription,
        feet: Mapping[str, str],
        *,
        trunk: str | None = None,
        home: ArrayLike | None = None,
        mass_centre: ArrayLike | None = None,
    ) -> LeggedRobot:
        """Take the legs from a robot's URDF.

        Parameters
        ----------
        description : RobotDescription
            See :func:`robomech_ros.robots.load_description`.
        feet : mapping of str to str
            The link of the foot of each leg, by the names of the legs.
        trunk : str, optional
            The link that carries the legs; default the root.
        home, mass_centre
            As for the class.

        Raises
        ------
        UnknownLinkError, RobotDescriptionError
            No such link, or no chain between the two.
        """
        check_kind("description", description, RobotDescription, "a RobotDescription")
        check_kind("feet", feet, Mapping, "links of feet by the names of the legs")
        legs = {leg: description.chain(trunk, foot) for leg, foot in feet.items()}
        return cls(
            legs,
            home=home,
            mass_centre=mass_centre,
            name=description.name,
            source=description.source,
            tree=description,
        )

    def joints(self, q: ArrayLike, what: str = "q") -> Array:
        """Return checked values of all joints, leg by leg, shape (k, 3)."""
        return np.ascontiguousarray(as_single(what, q, (self.n,)).reshape(-1, JOINTS))

    def leg_number(self, leg: str) -> int:
        """Return the index of a leg; the error for an unknown name lists the legs."""
        return self.leg_names.index(as_choice("leg", leg, self.leg_names))

    def standing(self, stance: Sequence[str] | None, least: int = 3) -> tuple[int, ...]:
        """Return the indices of the standing legs; None stands for all."""
        whole_number("least", least, f"a number of legs from 0 to {MOST_LEGS}", 0, MOST_LEGS)
        if stance is None:
            return tuple(range(len(self.legs)))
        names = listed("stance", stance, "names of legs")
        numbers = tuple(sorted({self.leg_number(name) for name in names}))
        if len(numbers) < least:
            raise BadValueError("legs that stand", list(names), f"at least {counted(least, 'leg')}")
        return numbers

    def feet(self, q: ArrayLike) -> Array:
        """Compute the positions of the feet in the trunk (m), shape (k, 3), at joints (3 k,)."""
        rows = self.joints(q)
        return np.array(
            [forward_kinematics(leg, row)[:3, 3] for leg, row in zip(self.legs, rows, strict=True)]
        )

    def foot_jacobians(self, q: ArrayLike) -> Array:
        """Compute the Jacobians (k, 3, 3) from leg rates to foot velocities in the trunk.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        """
        rows = self.joints(q)
        return np.array([jacobian(leg, row)[3:] for leg, row in zip(self.legs, rows, strict=True)])

    def check_regular(self, q: ArrayLike, J: Array, standing: Sequence[int]) -> None:
        """Reject :meth:`foot_jacobians` J if a leg of ``standing`` (indices) is singular."""
        values = np.linalg.svd(J[list(standing)], compute_uv=False)
        for k, (largest, _, least) in zip(standing, values, strict=True):
            if least <= ZERO * largest:
                what = f"posture of leg '{self.leg_names[k]}'"
                raise BadValueError(what, self.joints(q)[k].tolist(), "one that is not singular")

    def postures(
        self,
        leg: str,
        foot: ArrayLike,
        *,
        seed: ArrayLike | None = None,
        respect_limits: bool = True,
    ) -> InverseKinematicsResult:
        """Find all postures of a leg for a position of its foot.

        Parameters
        ----------
        leg : str
            Name of the leg.
        foot : array_like, shape (3,)
            In the trunk (m).
        seed : array_like, shape (3,), optional
            Posture of the leg (rad or m); the nearest to it comes first.  Default home.
        respect_limits : bool, optional
            Whether postures outside the limits are left out.

        Returns
        -------
        InverseKinematicsResult
            All branches, or the reason why there are none.
        """
        k = self.leg_number(leg)
        T = np.eye(4)
        T[:3, 3] = as_single("foot", foot, (3,))
        near = self.home.reshape(-1, JOINTS)[k] if seed is None else seed
        return inverse_kinematics(
            self.legs[k], T, seed=near, respect_limits=respect_limits, task_mask=_PLACE
        )

    def stance_rates(
        self, q: ArrayLike, twist: ArrayLike, stance: Sequence[str] | None = None
    ) -> Array:
        """Compute the joint rates that move the trunk while feet stand still.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        twist : array_like, shape (6,)
            [w; v] of the trunk over the ground, at its origin and in its axes (rad/s, m/s).
        stance : sequence of str, optional
            The standing legs, default all; joints of the others stand still.

        Returns
        -------
        ndarray, shape (3 k,)
            rad/s or m/s.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 10.4.
        """
        N, _ = self.planted_legs(q, stance)
        return np.asarray(N[6:, :6] @ as_vector("twist", twist, 6))

    def planted_legs(
        self, q: ArrayLike, stance: Sequence[str] | None, independent: ArrayLike = _STILL
    ) -> tuple[Array, Array]:
        """Compute the orthogonal complement N of a stance, and the motion for given speeds w.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        stance : sequence of str or None
            Names of the standing legs; None for all.
        independent : array_like, shape (6 + 3 m,), optional
            w: the twist of the trunk, then the joint rates of the m legs in the air.  Default zero.

        Returns
        -------
        N : ndarray, shape (6 + 3 k, 6 + 3 m)
            Complement of :class:`WalkingDynamics`: it takes w to all rates.
        motion : ndarray, shape (2, 6 + 3 k)
            ``N w``, and its derivative while w is constant.

        Raises
        ------
        BadValueError
            A standing leg is singular.
        """
        standing, rows = self.standing(stance, 1), self.joints(q)
        stands = np.array([k in standing for k in range(len(self.legs))], dtype=np.int64)
        size = 6 + self.n - JOINTS * len(standing)
        w = np.zeros(size) if independent is _STILL else as_vector("independent", independent, size)
        N, motion = np.empty((6 + self.n, size)), np.empty((2, 6 + self.n))
        if _planted_legs(self.packed, rows, stands, np.ascontiguousarray(w), N, motion):
            self.check_regular(q, self.foot_jacobians(q), standing)
        return N, motion

    def body_twist(
        self, q: ArrayLike, rates: ArrayLike, stance: Sequence[str] | None = None
    ) -> tuple[Array, float]:
        """Find the twist of the trunk from the rates of the legs that stand.

        Parameters
        ----------
        q, rates : array_like, shape (3 k,)
            All joints and their rates (rad or m, and s).
        stance : sequence of str, optional
            The legs that stand, default all.

        Returns
        -------
        twist : ndarray, shape (6,)
            [w; v] of the trunk over the ground, at its origin and in its axes (rad/s, m/s), the
            one with which the feet slip least.
        slip : float
            Root of the sum of the squares of the velocities (m/s) with which the feet slip.

        Raises
        ------
        BadValueError, WrongSizeError
            Fewer than three legs, or feet that stand on one line.
        """
        standing = list(self.standing(stance))
        speeds = np.einsum("kij,kj->ki", self.foot_jacobians(q), self.joints(rates, "rates"))
        rows = contact_rows(self.feet(q)[standing])
        found, _, rank, _ = np.linalg.lstsq(rows, -speeds[standing].ravel(), rcond=ZERO)
        if rank < 6:
            names = [self.leg_names[k] for k in standing]
            raise BadValueError("feet that stand", names, "feet that are not on one line")
        slip = math.hypot(*(rows @ found + speeds[standing].ravel()))
        return found, slip

    def planted(self, q: ArrayLike, stance: Sequence[str] | None = None) -> Mechanism:
        """Return the parallel robot that planted feet make: the trunk is its platform.

        Its base is the ground, in the frame of the trunk as it is; a foot is a ball joint.  All
        joints are counted from the posture given, where they are zero, and keep their names; six
        of them, those that hold the trunk best, are its drives.

        Parameters
        ----------
        q : array_like, shape (3 k,)
            All joints (rad or m).
        stance : sequence of str, optional
            The legs that stand, default all.

        Returns
        -------
        Mechanism
            See :class:`robomech_ros.parallel.Mechanism`.

        Raises
        ------
        BadValueError, WrongSizeError
            Fewer than three legs, or a posture in which no six joints hold the trunk.
        """
        standing = self.standing(stance)
        return stance_mechanism(
            [self.leg_names[k] for k in standing],
            [self.legs[k] for k in standing],
            self.joints(q)[list(standing)],
            self.name,
        )
