"""Closed-form kinematics and dynamics of a chain, as expressions of SymPy.

The inertia of what follows each joint is gathered from the tip to the base, in frames that turn
with the links, and seen by the axes of the joints before it; Christoffel symbols and the gradient
of the potential energy are exact derivatives.  An optional part: it needs ``pip install
robomech_ros[symbolic]``.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 4.2, 5.2 and 7.3 to 7.6.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy

from robomech_ros.dynamics.checked_states import as_vector
from robomech_ros.dynamics.model import GRAVITY
from robomech_ros.dynamics.symbolic.composites import potential_moment, symbolic_mass_rows
from robomech_ros.dynamics.symbolic.parameters import SymbolicParameters, symbolic_parameters
from robomech_ros.dynamics.symbolic.poses import Matrix, polynomials, symbolic_frames
from robomech_ros.dynamics.symbolic.terms import Poly
from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.numerics.arrays import real_array
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array, ArrayLike

EXPRESSIONS = (
    "forward_kinematics",
    "jacobian",
    "mass_matrix",
    "coriolis_matrix",
    "gravity_torque",
    "torque",
    "friction_torque",
)
_WITHOUT_BODIES = ("forward_kinematics", "jacobian", "friction_torque")


@dataclass(frozen=True, eq=False)
class SymbolicModel:
    """Closed forms of a chain; each is derived when it is first asked for.

    Parameters
    ----------
    chain : SerialChain
        What they are of.
    parameters : SymbolicParameters
        Symbols, and what they stand for.
    """

    chain: SerialChain
    parameters: SymbolicParameters

    @cached_property
    def forward_kinematics(self) -> sympy.Matrix:
        """Pose of the tip in the base, shape (4, 4) (m)."""
        parameters = self.parameters
        poses, _ = symbolic_frames(parameters)
        inner = self._matrix(poses[-1])
        return (parameters.base * inner * parameters.tool).applyfunc(sympy.expand_mul)

    @cached_property
    def jacobian(self) -> sympy.Matrix:
        """Joint rates to the tip's twist [omega; v] in the base, shape (6, n) (1 and m)."""
        parameters = self.parameters
        ring = parameters.ring
        R, point = parameters.base[:3, :3], self.forward_kinematics[:3, 3]
        columns = []
        _, axes = symbolic_frames(parameters)
        for axis, variable, turns in zip(
            axes, parameters.variables, parameters.revolute, strict=True
        ):
            e = R * sympy.Matrix([ring.expression(one) for one in axis])
            velocity = point.diff(variable)
            columns.append((e if turns else sympy.zeros(3, 1)).col_join(velocity))
        return sympy.Matrix.hstack(*columns)

    @cached_property
    def mass_matrix(self) -> sympy.Matrix:
        """Generalised inertia, shape (n, n) (kg m^2, kg m, kg), with the rotors'."""
        return self._matrix(self._mass_rows) + sympy.diag(*self.parameters.rotors)

    @cached_property
    def coriolis_matrix(self) -> sympy.Matrix:
        """Matrix C with ``C qd`` the Coriolis and centrifugal torques, by Christoffel symbols."""
        write, rates, n = self.parameters.ring.expression, self.parameters.rates, self.chain.n
        variables = np.array(self.parameters.variables, object)
        derivative = np.frompyfunc(self.parameters.ring.derivative, 2, 1)
        D = derivative(self._mass_rows[:, :, None], variables)
        symbols = D + np.swapaxes(D, 1, 2) - np.moveaxis(D, -1, 0)

        def entry(i: int, j: int) -> sympy.Expr:
            terms = zip(symbols[int(i), int(j)], rates, strict=True)
            return sympy.Add(*(write(one / 2) * rate for one, rate in terms if one))

        return sympy.Matrix(n, n, entry)

    @cached_property
    def gravity_torque(self) -> sympy.Matrix:
        """Torques that hold the weights, shape (n, 1): the gradient of the potential energy."""
        parameters = self.parameters
        ring = parameters.ring
        weight = polynomials(ring, parameters.gravity)
        energy = -ring.times(weight, potential_moment(parameters)).sum()
        gradient = [ring.expression(ring.derivative(energy, one)) for one in parameters.variables]
        return sympy.Matrix(gradient)

    @cached_property
    def torque(self) -> sympy.Matrix:
        """Torques and forces of the drives for a motion, shape (n, 1), without their friction."""
        parameters = self.parameters
        moved = self.mass_matrix * sympy.Matrix(parameters.accelerations)
        return moved + self.coriolis_matrix * sympy.Matrix(parameters.rates) + self.gravity_torque

    @cached_property
    def friction_torque(self) -> sympy.Matrix:
        """Torques and forces that the friction of the drives takes, shape (n, 1)."""
        return sympy.Matrix(self.parameters.friction)

    def expression(self, what: str) -> sympy.Matrix:
        """Return one of :data:`EXPRESSIONS` by name.

        Raises
        ------
        MissingInertiaError
            It needs masses that are not known.
        """
        name = as_choice("expression", what, EXPRESSIONS)
        if name not in _WITHOUT_BODIES:
            _ = self.chain.packed_bodies  # raises where masses are missing
        return getattr(self, name)

    def compiled(self, what: str) -> Callable[..., Array]:
        """Make a function of one of :data:`EXPRESSIONS`, with common terms computed once.

        Returns
        -------
        callable
            ``f(q, qd=0, qdd=0)`` for the chain's own joint values, each (n,) or (..., n); the
            result has the batch axes first.
        """
        matrix, parameters = self.expression(what), self.parameters
        symbols, values = tuple(parameters.values), tuple(parameters.values.values())
        arguments = (parameters.variables, parameters.rates, parameters.accelerations, symbols)
        entries = sympy.lambdify(arguments, list(matrix), modules="numpy", cse=True)
        shape = matrix.shape if matrix.shape[1] > 1 else matrix.shape[:1]

        def evaluate(q: ArrayLike, qd: ArrayLike = 0.0, qdd: ArrayLike = 0.0) -> Array:
            rows = [real_array(name, one) for name, one in (("q", q), ("qd", qd), ("qdd", qdd))]
            if rows[0].ndim == 0 or rows[0].shape[-1] != self.chain.n:
                raise WrongSizeError("q", rows[0].shape, f"(..., {self.chain.n})")
            rows[0] = rows[0] + parameters.offsets
            rows = [np.broadcast_to(one, rows[0].shape) for one in rows]
            found = entries(*(tuple(np.moveaxis(one, -1, 0)) for one in rows), values)
            batch = rows[0].shape[:-1]
            stacked = np.stack([np.broadcast_to(one, batch) for one in found], axis=-1)
            return np.asarray(stacked, dtype=np.float64).reshape(*batch, *shape)

        return evaluate

    @cached_property
    def _mass_rows(self) -> Matrix:
        return symbolic_mass_rows(self.parameters)

    def _matrix(self, rows: Iterable[Iterable[Poly]]) -> sympy.Matrix:
        ring = self.parameters.ring
        return sympy.Matrix([[ring.expression(one) for one in row] for row in rows])


def symbolic_model(
    chain: SerialChain, *, gravity: ArrayLike = GRAVITY, parameters: str = "names"
) -> SymbolicModel:
    """Set up the closed forms of a chain.

    Parameters
    ----------
    chain : SerialChain
        Chain of at least one joint.
    gravity : array_like, shape (3,)
        In the base (m/s^2).  Along an axis of the first frame it is called g, else g_x, g_y, g_z.
    parameters : {"names", "numbers"}
        Symbols a_i, b_i, alpha_i of the Denavit-Hartenberg table, m_i, x_i, y_i, z_i, I_xxi and so
        on of the bodies in frame i + 1, or their values as exact decimals.  What vanishes is 0 and
        right angles are exact either way.
    """
    check_chain(chain)
    by_name = as_choice("parameters", parameters, ("names", "numbers")) == "names"
    vector = as_vector("gravity", gravity, 3)
    return SymbolicModel(
        chain, symbolic_parameters(chain, [float(one) for one in vector], by_name=by_name)
    )
