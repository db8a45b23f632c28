"""Rigid bodies whose constraints leave some independent rates: serial, parallel, rolling.

The twists ``t_i = [omega_i; v_i]`` of r bodies, v_i of the mass centre, are stacked to t.  What
keeps them together, joints that form chains and loops or wheels that roll, leaves m independent
rates u, and ``t = T u``.  T is an orthogonal complement of the constraints ``K t = 0``, so wrenches
that keep these drop out of ``T^T w``.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.5 and 12.3 to 12.5.
Angeles and Lee, The formulation of dynamical equations of holonomic mechanical systems using a
natural orthogonal complement, ASME J. Applied Mechanics 55 (1988), pp. 243-244.
Saha and Angeles, Dynamics of nonholonomic mechanical systems using a natural orthogonal
complement, ASME J. Applied Mechanics 58 (1991), pp. 238-243.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.dynamics.checked_states import as_vector, finite_result
from robomech_ros.dynamics.complement.stacking import (
    extended_angular_velocity,
    extended_mass,
    solve,
    times,
    transposed,
)
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite, of_shape
from robomech_ros.typing import Array, ArrayLike

_OPTIONAL = ("rotors", "N", "N_dot", "t_0", "t_0_dot", "A")


@dataclass(frozen=True, eq=False, kw_only=True)
class ConstrainedBodies:
    r"""Bodies in motion, and all that follows from how their constraints shape their twists.

    The one object for the dynamics of systems of every kind.  A serial chain is a case of it
    (:func:`natural_orthogonal_complement`), so are parallel robots (``ParallelDynamics.bodies``);
    of anything else give the arrays.  With :math:`t = T u + t_0` for the independent rates u,

    .. math::

       I \dot u + C u = T^T w, \qquad I = T^T M T, \qquad C = T^T M \dot T + T^T W M T

    with :math:`M = \mathrm{diag}(I_i, m_i 1)` and :math:`W = \mathrm{diag}(\Omega_i, 0)`.  This
    holds for nonholonomic constraints, too.  It is for what is read, checked and taken apart: for
    the torques of a chain or of a parallel robot alone :func:`inverse_dynamics` and
    ``ParallelDynamics.inverse`` are compiled.

    All vectors are in the axes of one frame, which is at rest.

    Parameters
    ----------
    masses : array_like, shape (r,)
        In kg; 0 for a link without mass.
    inertias : array_like, shape (r, 3, 3) or (..., r, 3, 3)
        About the mass centres (kg m^2).
    T : array_like, shape (..., 6 r, m)
        Twist-shaping matrix: column j holds the twists of the bodies at a unit of rate j.
    T_dot : array_like, of the same shape
        Its rate.
    rates : array_like, shape (..., m)
        u (rad/s, m/s, or whatever T takes).
    rotors : array_like, shape (k,), optional
        Inertias of rotors, as they add to rates of joints (kg m^2 or kg).  Default none.
    N, N_dot : array_like, shape (k, m) or (..., k, m), optional
        To the rates of these joints from u, and its rate.  Default the rates u themselves, k = m.
    t_0, t_0_dot : array_like, shape (6 r,) or (..., 6 r), optional
        Twists that a prescribed motion, as of a base, adds, and their rates.  Default none.
    A : array_like, shape (..., 6 r, m), optional
        Wrenches on the bodies for units of the efforts that drives exert, ``T^T A = 1``: only
        :meth:`constraint_wrenches` needs it.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.5 and 12.3.

    Examples
    --------
    A particle of 2 kg on a circle of 0.5 m, at rest in its own highest place, under gravity along
    -y, and one degree beside it:

    >>> import numpy as np
    >>> from robomech_ros.dynamics import ConstrainedBodies
    >>> angle = np.radians(91.0)
    >>> T = np.zeros((6, 1))
    >>> T[2, 0], T[3:5, 0] = 1.0, [-0.5 * np.sin(angle), 0.5 * np.cos(angle)]
    >>> ring = ConstrainedBodies(
    ...     masses=[2.0], inertias=np.zeros((1, 3, 3)), T=T, T_dot=np.zeros((6, 1)), rates=[0.0]
    ... )
    >>> np.round(ring.forward([0.0], ring.gravity_wrenches([0.0, -9.81, 0.0])), 4)
    array([0.3424])
    """

    masses: Array
    inertias: Array
    T: Array
    T_dot: Array
    rates: Array
    rotors: Array | None = None
    N: Array | None = None
    N_dot: Array | None = None
    t_0: Array | None = None
    t_0_dot: Array | None = None
    A: Array | None = None

    def __post_init__(self) -> None:
        masses = as_finite("masses", self.masses, ())
        if masses.ndim != 1 or not len(masses):
            raise WrongSizeError("masses", masses.shape, "(r,) of one body or more")
        rates = as_finite("rates", self.rates, ())
        if not rates.ndim or not rates.shape[-1]:
            raise WrongSizeError("rates", rates.shape, "(..., m) of one rate or more")
        r, batch, m = len(masses), rates.shape[:-1], rates.shape[-1]
        k = m
        if self.rotors is not None and self.N is not None:
            k = as_finite("rotors", self.rotors, ()).size
        shapes: dict[str, tuple[int, ...]] = {
            "masses": (r,),
            "inertias": (r, 3, 3),
            "T": (6 * r, m),
            "T_dot": (6 * r, m),
            "rates": (m,),
            "rotors": (k,),
            "N": (k, m),
            "N_dot": (k, m),
            "t_0": (6 * r,),
            "t_0_dot": (6 * r,),
            "A": (6 * r, m),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            array = as_finite(name, value, shape)
            if array.shape not in (shape, (*batch, *shape)):
                raise WrongSizeError(name, array.shape, f"{shape} or {(*batch, *shape)}")
            object.__setattr__(self, name, array)
        for name in ("masses", "rotors"):
            value = getattr(self, name)
            if value is not None and (value < 0.0).any():
                raise BadValueError(f"least of {name}", float(value.min()), "none below 0")

    @cached_property
    def M(self) -> Array:
        """Extended mass matrix, blocks diag(I_i, m_i 1), shape (..., 6 r, 6 r)."""
        return extended_mass(self.masses, self.inertias)

    @cached_property
    def W(self) -> Array:
        """Extended angular-velocity matrix, blocks diag(Omega_i, 0), shape (..., 6 r, 6 r)."""
        return extended_angular_velocity(self.twists.reshape(*self.rates.shape[:-1], -1, 6))

    @cached_property
    def twists(self) -> Array:
        """The bodies' twists t, shape (..., 6 r)."""
        free = times(self.T, self.rates)
        return free if self.t_0 is None else free + self.t_0

    @cached_property
    def generalised_inertia(self) -> Array:
        """``I = T^T M T`` and the rotors' inertias, shape (..., m, m) (kg m^2, kg m, kg)."""
        inertia: Array = transposed(self.T) @ self.M @ self.T
        if self.rotors is None:
            return inertia
        if self.N is None:
            return np.asarray(inertia + np.diag(self.rotors))
        return np.asarray(inertia + transposed(self.N) @ (self.rotors[:, None] * self.N))

    @cached_property
    def coupling(self) -> Array:
        """``C = T^T M T_dot + T^T W M T`` and that of the rotors, shape (..., m, m).

        ``dI/dt - 2 C`` is skew-symmetric where nothing is prescribed.
        """
        coupling: Array = transposed(self.T) @ (self.M @ self.T_dot + self.W @ self.M @ self.T)
        if self.rotors is None or self.N is None or self.N_dot is None:
            return coupling
        return np.asarray(coupling + transposed(self.N) @ (self.rotors[:, None] * self.N_dot))

    @cached_property
    def prescribed_effort(self) -> Array:
        """Effort of a prescribed motion, ``T^T (M dt_0/dt + W M t_0)``, shape (..., m)."""
        effort = np.zeros_like(self.rates)
        if self.t_0_dot is not None:
            effort = effort + times(transposed(self.T), times(self.M, self.t_0_dot))
        if self.t_0 is not None:
            momentum = times(self.M, self.t_0)
            effort = effort + times(transposed(self.T), times(self.W, momentum))
        return effort

    @cached_property
    def kinetic_energy(self) -> Array:
        """Kinetic energy of bodies and rotors, shape () or (...,) (J)."""
        energy = 0.5 * np.sum(self.twists * times(self.M, self.twists), axis=-1)
        if self.rotors is not None:
            spins = self.rates if self.N is None else times(self.N, self.rates)
            energy = energy + 0.5 * np.sum(self.rotors * spins**2, axis=-1)
        return np.asarray(energy)

    def gravity_wrenches(self, gravity: ArrayLike) -> Array:
        """Weights ``[0; m_i g]`` of the bodies, shape (6 r,), for g in m/s^2, shape (3,)."""
        wrenches = np.zeros((len(self.masses), 6))
        wrenches[:, 3:] = np.outer(self.masses, as_vector("gravity", gravity, 3))
        return wrenches.ravel()

    def generalised(self, wrenches: Array) -> Array:
        """Efforts ``T^T w`` (..., m) that wrenches (..., 6 r) on the bodies amount to."""
        return times(transposed(self.T), wrenches)

    @finite_result
    def power(self, wrenches: ArrayLike) -> Array:
        """Power (W), shape () or (...,), of wrenches (..., 6 r) on the bodies."""
        given = as_finite("wrenches", wrenches, (self.T.shape[-2],))
        return np.asarray(np.sum(self.twists * given, axis=-1))

    @finite_result
    def inverse(self, accelerations: ArrayLike, wrenches: ArrayLike | None = None) -> Array:
        """Compute the efforts that a motion takes, ``I du/dt + C u - T^T w``.

        Parameters
        ----------
        accelerations : array_like, shape (..., m)
            du/dt.
        wrenches : array_like, shape (6 r,) or (..., 6 r), optional
            What acts on the bodies besides, such as weights and friction.  Default nothing.

        Returns
        -------
        ndarray, shape (..., m)
            Whose power at the rates is ``u`` times them: torques (N m) of rates in rad/s.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.3.
        """
        given = self._of_rates("accelerations", accelerations)
        return times(self.generalised_inertia, given) + self._bias(wrenches)

    @finite_result
    def forward(self, efforts: ArrayLike, wrenches: ArrayLike | None = None) -> Array:
        """Compute the accelerations du/dt that efforts cause, by Cholesky's factors of I.

        Parameters
        ----------
        efforts : array_like, shape (..., m)
            As :meth:`inverse` returns them.
        wrenches : array_like, shape (6 r,) or (..., 6 r), optional
            As for :meth:`inverse`.

        Returns
        -------
        ndarray, shape (..., m)

        Raises
        ------
        BadValueError
            Nothing resists some motion.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.6 and 12.3.
        """
        moving = self._of_rates("efforts", efforts) - self._bias(wrenches)
        L = np.asarray(np.linalg.cholesky(self.generalised_inertia), dtype=np.float64)
        return solve(transposed(L), solve(L, moving))

    @finite_result
    def inertia_wrenches(self, accelerations: ArrayLike) -> Array:
        """``M dt/dt + W M t`` (..., 6 r): what has to act on the bodies for accelerations du/dt."""
        given = self._of_rates("accelerations", accelerations)
        rate = times(self.T, given) + times(self.T_dot, self.rates)
        if self.t_0_dot is not None:
            rate = rate + self.t_0_dot
        return times(self.M, rate) + times(self.W, times(self.M, self.twists))

    @finite_result
    def constraint_wrenches(self, accelerations: ArrayLike, applied: ArrayLike) -> Array:
        """Compute the wrenches that keep the constraints.

        Parameters
        ----------
        accelerations : array_like, shape (..., m)
            du/dt.
        applied : array_like, shape (6 r,) or (..., 6 r)
            Wrenches on the bodies besides those of drives and constraints: weights, loads,
            friction of joints without a drive.

        Returns
        -------
        ndarray, shape (..., 6 r)
            ``[n_i; f_i]`` at the mass centres; ``T^T w = 0``.  They are unique, also where the
            multipliers of the constraints are not (:func:`constraint_reactions`).

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.5.
        """
        if self.A is None:
            raise BadValueError("A", None, "the wrenches of the drives, shape (..., 6 r, m)")
        needed = self.inertia_wrenches(accelerations) - as_finite(
            "applied", applied, (self.T.shape[-2],)
        )
        return needed - times(self.A, self.generalised(needed))

    def _bias(self, wrenches: ArrayLike | None) -> Array:
        """Efforts at which no rate changes."""
        bias = times(self.coupling, self.rates) + self.prescribed_effort
        if wrenches is None:
            return bias
        return bias - self.generalised(as_finite("wrenches", wrenches, (self.T.shape[-2],)))

    def _of_rates(self, what: str, value: ArrayLike) -> Array:
        return of_shape(what, as_finite(what, value, self.rates.shape[-1:]), self.rates.shape)
