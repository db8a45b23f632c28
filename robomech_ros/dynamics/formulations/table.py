"""The formulations of inverse and forward dynamics by name; they check each other."""

from collections.abc import Callable
from typing import Any

from robomech_ros.dynamics.formulations import dynamics_by_complement, kane, lagrange
from robomech_ros.errors import BadValueError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array, ArrayLike

INVERSE: dict[str, Callable[..., Array]] = {
    "orthogonal-complement": dynamics_by_complement.inverse_dynamics_by_orthogonal_complement,
    "lagrange": lagrange.inverse_dynamics_by_lagrange,
    "kane": kane.inverse_dynamics_by_kane,
}
FORWARD: dict[str, Callable[..., Array]] = {
    "reflections": dynamics_by_complement.forward_dynamics_by_reflections,
    "lagrange": lagrange.forward_dynamics_by_lagrange,
    "kane": kane.forward_dynamics_by_kane,
}
_FOR_MOVING_BASES = ("orthogonal-complement", "reflections")


def by_formulation(
    table: dict[str, Callable[..., Array]],
    method: str,
    chain: SerialChain,
    *state: ArrayLike,
    base: dict[str, ArrayLike | None],
    **around: Any,
) -> Array:
    """Compute torques or accelerations by the formulation of a name in one of the tables."""
    motion = {name: value for name, value in base.items() if value is not None}
    if motion and method not in _FOR_MOVING_BASES:
        expected = "a formulation for bases that move, or a base at rest"
        raise BadValueError("method", method, expected)
    return table[method](chain, *state, **around, **motion)
