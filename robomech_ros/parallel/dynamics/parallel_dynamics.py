"""Dynamics of parallel robots over their drives."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomech_ros._kernels.loops import dynamics as kernels
from robomech_ros._kernels.loops.factors import NOT_FINITE, REGULAR
from robomech_ros.dynamics import ConstrainedBodies
from robomech_ros.dynamics.drive_control import CompiledServo, ServoLaw
from robomech_ros.dynamics.friction import friction_model, friction_of_rates
from robomech_ros.dynamics.model import GRAVITY, surroundings
from robomech_ros.dynamics.systems import CompiledForward, LostPostureError
from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinematics.posture_samples import spread_values
from robomech_ros.outcomes import Code
from robomech_ros.parallel.argument_checks import actuated
from robomech_ros.parallel.dynamics.complement import (
    JointReactions,
    bodies_in_motion,
    joint_reactions,
)
from robomech_ros.parallel.dynamics.model import (
    as_rows,
    complements,
    finite,
    limb_totals,
    loop_arguments,
    loop_servo,
    platform_body,
    refuse,
    states,
)
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.robots import Body, combine_bodies
from robomech_ros.robots.bodies import possible_body
from robomech_ros.typing import Array, ArrayLike, IntArray

# Number of spread postures: each costs as much as closing the loops.
_MOST_POSTURES = 256
# How far loops may be open by rounding (m over the robot's size, rad).
_OPEN = 1e-6


class ParallelDynamics:
    r"""The dynamics of a parallel robot, by the natural orthogonal complement of its loops.

    With the rates :math:`\dot q = N \dot a` of all n joints for those of the m drives, and the
    mass matrix M and the bias h of the open limbs,

    .. math::

       \tau = N^T (M \ddot q + h), \qquad I = N^T M N, \qquad
       \ddot q = N \ddot a + \dot N \dot a

    which is :math:`T^T (M \dot t + W M t)` with :math:`T = T_{open} N`.  Attributes and methods
    have the names of :class:`DynamicSystem`, so ``simulate`` and ``torque_summary`` take it as
    they take a chain.  Joint values q, shape (..., n), are those of all joints, and close all
    loops; rates, accelerations and efforts, shape (..., m), are those of the drives, in the order
    of ``mechanism.actuated``.  Efforts are without friction: add :meth:`friction`.

    Parameters
    ----------
    mechanism : Mechanism
        With the body of its platform; links of which nothing is known have no mass.

    Raises
    ------
    BadValueError
        Not a mechanism.  What needs the mass of a platform of which nothing is known raises
        MissingInertiaError.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 12.3 and 12.4.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import ParallelDynamics, load_parallel
    >>> robot = load_parallel("delta").mechanism
    >>> dynamics, q, still = ParallelDynamics(robot), robot.home(), np.zeros(3)
    >>> holding = dynamics.inverse(q, still, still)  # N m
    >>> np.allclose(dynamics.forward(q, still, holding), 0.0, atol=1e-9)
    True
    """

    def __init__(self, mechanism: Mechanism) -> None:
        if not isinstance(mechanism, Mechanism):
            raise BadValueError("mechanism", mechanism, "a Mechanism")
        self.mechanism, self.name = mechanism, mechanism.name
        self.joint_names, self.drive_names = mechanism.joint_names, mechanism.actuated
        self.drives_at: IntArray = mechanism.drive_index
        self.lower, self.upper = mechanism.lower, mechanism.upper
        self.effort = mechanism.effort[self.drives_at]
        self.velocity = mechanism.velocity[self.drives_at]
        friction = [friction_model(limb.chain) for limb in mechanism.limbs]
        self.friction_rows = np.concatenate(friction, axis=1)

    @property
    def mass(self) -> float:
        """Total moving mass (kg)."""
        return float(limb_totals(self.mechanism, *np.zeros((2, self.mechanism.n)))[0])

    def checked_posture(self, q: ArrayLike, what: str = "q") -> Array:
        """Return joint values (n,) that close all loops, or raise an error.

        Loops that are open by rounding, up to 1e-6 rad and of the robot's size, are closed.
        """
        given = actuated(what, q, self.mechanism.n)
        units = np.array([self.mechanism.size, 1.0])
        with np.errstate(over="ignore", invalid="ignore"):
            errors = self.mechanism.loop_errors(given)
        if not (errors <= _OPEN * units).all():
            raise self.mechanism.open_loops(given, what)
        found = self.mechanism.close(given[self.drives_at], given)
        if found.status != Code.NONE:
            raise BadValueError(what, given.tolist(), f"closed loops; {found.reason}")
        return found.q

    def posture(self, values: Array, near: Array) -> Array:
        """Return all joints (n,) for values of the drives (m,), in the assembly mode of ``near``.

        LostPostureError says where the mode ends before, in a singular posture.
        """
        found = self.mechanism.close(values, near)
        if found.status != Code.NONE:
            raise LostPostureError(f"the assembly mode is lost: {found.reason}")
        return found.q

    def complement(self, q: ArrayLike) -> Array:
        """Return N (..., n, m), from the rates of the drives to those of all joints."""
        return self.mechanism.complement(q)

    def joint_rates(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Return the rates of all joints (..., n)."""
        return self.mechanism.rates(q, rates)[0]

    def tip_twist(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Return the twist [omega; v] (..., 6) of the platform in the base."""
        return self.mechanism.rates(q, rates)[1]

    def inverse(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        gravity: ArrayLike = GRAVITY,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the efforts of the drives that a motion takes.

        Parameters
        ----------
        q : array_like, shape (n,) or (..., n)
            All joints (rad or m), loops closed.
        rates, accelerations : array_like, shape (m,) or (..., m)
            Of the drives (rad/s or m/s; per s).
        gravity : array_like, shape (3,), optional
            In the axes of the base (m/s^2).
        tip_wrench : array_like, shape (6,) or (..., 6), optional
            Moment and force [n; f] that the surroundings exert on the platform, at its origin, in
            the axes of the base (N m and N).  Default none.

        Returns
        -------
        ndarray, shape (m,) or (..., m)
            Torques or forces (N m or N).

        Raises
        ------
        BadValueError, WrongSizeError
            Not finite real numbers of these shapes, open loops, or a singular posture.
        """
        given = states(self.mechanism, q, rates=rates, accelerations=accelerations)
        return self._of_drives(kernels.inverse, given, gravity, tip_wrench)

    def forward(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        efforts: ArrayLike,
        *,
        gravity: ArrayLike = GRAVITY,
        tip_wrench: ArrayLike | None = None,
    ) -> Array:
        """Compute the accelerations of the drives that efforts cause.

        Parameters
        ----------
        q, rates, gravity, tip_wrench
            As for :meth:`inverse`.
        efforts : array_like, shape (m,) or (..., m)
            Efforts of the drives, friction taken off (N m or N).

        Returns
        -------
        ndarray, shape (m,) or (..., m)
            Accelerations (rad/s^2 or m/s^2).
        """
        given = states(self.mechanism, q, rates=rates, efforts=efforts)
        return self._of_drives(kernels.forward, given, gravity, tip_wrench)

    def _of_drives(
        self, kernel: Any, given: list[Array], gravity: ArrayLike, tip_wrench: ArrayLike | None
    ) -> Array:
        around, out = surroundings(given[0].shape, gravity, tip_wrench), np.empty(given[1].shape)
        loops, rows = loop_arguments(self.mechanism), [as_rows(one) for one in (*given, out)]
        refuse(self.mechanism, kernel(*loops, *rows[:3], around, rows[3]), given[0])
        return finite(out)

    def compiled_forward(self, gravity: ArrayLike, tip_wrench: ArrayLike | None) -> CompiledForward:
        """Return :meth:`forward` of single states without checks: accelerations into the last.

        LostPostureError is raised where the posture is singular or open.
        """
        around = surroundings((self.mechanism.n,), gravity, tip_wrench)
        loops = loop_arguments(self.mechanism)

        def forward(q: Array, rates: Array, efforts: Array, out: Array) -> int:
            given = q[None], rates[None], efforts[None]
            status = int(kernels.forward(*loops, *given, around, out[None]))
            if status not in (REGULAR, NOT_FINITE):
                try:
                    refuse(self.mechanism, status, q)
                except RobomechError as error:
                    raise LostPostureError(str(error)) from None
            return status

        return forward

    def compiled_servo(self, plant: ParallelDynamics, law: ServoLaw) -> CompiledServo:
        """Simulate a controller with the model of this robot on it, or on a loaded one."""
        friction = plant.friction_rows, self.friction_rows
        return loop_servo(self.mechanism, plant.mechanism, friction, law)

    def sampled_postures(self, count: int) -> Array:
        """Spread postures (k, n), at most count, over the assembly mode of home."""
        robot, drives = self.mechanism, self.drives_at
        limits = robot.lower[drives], robot.upper[drives]
        count = min(count, _MOST_POSTURES)
        return robot.midway_postures(spread_values(robot.types[drives], *limits, count))

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Compute the generalised inertia ``N^T M N``, shape (..., m, m), with the rotors."""
        (given,) = states(self.mechanism, q)
        m = self.mechanism.dof
        out = np.empty((*given.shape[:-1], m, m))
        loops, rows = loop_arguments(self.mechanism), as_rows(given)
        refuse(self.mechanism, kernels.inertias(*loops, rows, out.reshape(-1, m, m)), given)
        return finite(out)

    def coriolis_matrix(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute C of the Coriolis and centrifugal efforts ``C rates``, shape (..., m, m).

        It is the ``coupling`` of :meth:`bodies`: the rate of the inertia less 2 C is skew.
        """
        return self.bodies(q, rates).coupling

    def gravity(self, q: ArrayLike, *, gravity: ArrayLike = GRAVITY) -> Array:
        """Compute the efforts (..., m) that hold the robot still under its weight."""
        (given,) = states(self.mechanism, q)
        still = np.zeros((*given.shape[:-1], self.mechanism.dof))
        return self.inverse(given, still, still, gravity=gravity)

    def friction(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute the efforts (..., m) that the friction of drives and passive joints takes."""
        q, rates = states(self.mechanism, q, rates=rates)
        N = self.mechanism.complement(q)
        lost = friction_of_rates(self.friction_rows, (N @ rates[..., None])[..., 0])
        return np.asarray((lost[..., None, :] @ N)[..., 0, :])

    def kinetic_energy(self, q: ArrayLike, rates: ArrayLike) -> Array:
        """Compute the kinetic energy of bodies and rotors, shape () or (...,) (J)."""
        q, rates = states(self.mechanism, q, rates=rates)
        sums = limb_totals(self.mechanism, q, self.joint_rates(q, rates))
        return finite(sums[..., 10])

    def potential_energy(self, q: ArrayLike, *, gravity: ArrayLike = GRAVITY) -> Array:
        """Compute the potential energy, shape () or (...,) (J): 0 with the mass at the base."""
        (given,) = states(self.mechanism, q)
        upwards = surroundings((self.mechanism.n,), gravity)[0, 6:9]
        moments = limb_totals(self.mechanism, given, np.zeros(given.shape))[..., 1:4]
        return finite(moments @ upwards)

    def bodies(self, q: ArrayLike, rates: ArrayLike) -> ConstrainedBodies:
        """Form the matrices of all links in motion, one for each joint.

        Parameters
        ----------
        q, rates
            As for :meth:`inverse`.

        Returns
        -------
        ConstrainedBodies
            The platform is the last link of the first limb; that of every other limb, and links
            of which nothing is known, have no mass.
        """
        q, rates = states(self.mechanism, q, rates=rates)
        return bodies_in_motion(self.mechanism, *complements(self.mechanism, q, rates))[0]

    def reactions(
        self,
        q: ArrayLike,
        rates: ArrayLike,
        accelerations: ArrayLike,
        *,
        gravity: ArrayLike = GRAVITY,
        tip_wrench: ArrayLike | None = None,
    ) -> JointReactions:
        """Find the wrenches that act in all joints, in one state.

        Parameters
        ----------
        q, rates, accelerations, gravity, tip_wrench
            As for :meth:`inverse`, of one state.
        """
        joints = self.checked_posture(q)
        joints, speeds, gains = states(
            self.mechanism, joints, rates=rates, accelerations=accelerations
        )
        around = surroundings((self.mechanism.n,), gravity, tip_wrench)[0]
        shaped = complements(self.mechanism, joints, speeds)
        return joint_reactions(self.mechanism, *shaped, gains, around)

    def with_payload(self, payload: Body) -> ParallelDynamics:
        """Return the robot whose platform carries a load, seen in the frame of the platform."""
        whole = combine_bodies((platform_body(self.mechanism), possible_body("payload", payload)))
        assert whole is not None
        return ParallelDynamics(self.mechanism.with_platform_body(whole))
