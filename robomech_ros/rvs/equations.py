"""Equations in two unknowns seen in a browser: curves, clicks on crossings, roots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.bivariate_roots import ANGLES
from robomech_ros.numerics.grid_crossings import Equations, GridProblem
from robomech_ros.rvs.opening import require_viser
from robomech_ros.rvs.serving.address import HOST, PORT

if TYPE_CHECKING:
    from robomech_ros.rvs.model.curves.curve_problems import Axis
    from robomech_ros.rvs.page.equations_page import EquationsPage

# Enough cells to see whether equations are what they should be.
_CELLS = 8


def view_equations(
    equations: Equations,
    bounds: ArrayLike = ANGLES,
    *,
    names: Sequence[str] = ("x", "y"),
    unit: str = "",
    pair: tuple[int, int] = (0, 1),
    period: float | None = None,
    port: int = PORT,
    host: str = HOST,
) -> EquationsPage:
    """Show the curves of two equations in a browser, and refine the crossings that are clicked on.

    Parameters
    ----------
    equations, bounds : callable, and array_like, shape (2, 2)
        As for :func:`~robomech_ros.numerics.bivariate`.
    names : sequence of two str, optional
        Names of the unknowns.
    unit : str, optional
        Of both; a turn in ``rad`` has its ticks at parts of pi.
    pair : tuple of int, optional
        The two equations that are drawn at first; which ones can be chosen on the page.
    period : float, optional
        With which all equations repeat in x and in y.
    port, host : int, str, optional
        As for :func:`view`.

    Returns
    -------
    EquationsPage
        Served until it is closed; ``url`` opens it, and contains the token that it asks for.

    Raises
    ------
    ViewUnavailableError, PortTakenError, AddressError
        As for :func:`view`.
    WrongSizeError, BadValueError
        As for :func:`~robomech_ros.numerics.bivariate`; no two names.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.rvs import view_equations
    >>> page = view_equations(
    ...     lambda x, y: [x**2 + y**2 - 4, x * y - 1], [[-3, 3], [-3, 3]], port=0
    ... )
    >>> page.url.split("=")[0].split("/")[-1]
    '?token'
    >>> page.close()
    """
    require_viser()
    from robomech_ros.rvs.page.equations_page import EquationsPage

    grid = GridProblem.of(equations, bounds, pair, period, _CELLS)
    problem = (equations, _axes(grid, names, unit), len(grid.scale), period)
    return EquationsPage(*problem, pair=grid.pair, port=port, host=host)


def _axes(grid: GridProblem, names: Sequence[str], unit: str) -> tuple[Axis, Axis]:
    from robomech_ros.rvs.model.curves.curve_problems import Axis

    if len(names) != 2 or not all(isinstance(name, str) for name in names):
        raise BadValueError("names", names, "two names")
    low, high = grid.low.tolist(), (grid.low + grid.width).tolist()
    x, y = names
    return Axis(x, unit, low[0], high[0]), Axis(y, unit, low[1], high[1])
