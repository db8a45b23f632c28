"""The page of equations in two unknowns: any browser may point at crossings, and all see it."""

from collections.abc import Callable, Hashable
from typing import Any

from robomech_ros.numerics.grid_crossings import Equations
from robomech_ros.rvs.model.curves.curve_problems import Axis, CurveProblem, equations_problem
from robomech_ros.rvs.page.curve_view import CurveOwner, CurveView
from robomech_ros.rvs.page.surroundings import set_theme
from robomech_ros.rvs.serving.server import ServedPage, guarded_server
from robomech_ros.rvs.serving.worker import Worker

# Width of the panel (pixels): all that a browser has, since there is no scene beside it.
WIDTH = 4000


class EquationsPage(ServedPage, CurveOwner):
    """A page of equations, served until it is closed.

    - ``equations``: as in :func:`~robomech_ros.rvs.view_equations`.
    - ``count``: number of equations.
    - ``pair``: indices of the two equations that are drawn at first, from 0.
    - ``port``, ``host``: as for :func:`robomech_ros.rvs.view`.
    """

    def __init__(
        self,
        equations: Equations,
        axes: tuple[Axis, Axis],
        count: int,
        period: float | None,
        *,
        pair: tuple[int, int],
        port: int,
        host: str,
    ) -> None:
        self._make = lambda both: equations_problem(equations, axes, both, count, period)
        self._server = guarded_server(host, port, "equations")
        self._worker = Worker()
        gui: Any = self._server.viser.gui
        with self._server.viser.atomic():
            set_theme(gui, False)
            gui.main_panel.dock_right()
            gui.main_panel.set_width(WIDTH)
            names = [f"equation {number}" for number in range(1, count + 1)]
            self._view = CurveView(gui, self, self._worker.submit, names, pair)
            dark = gui.add_checkbox("dark", False)

        @dark.on_update
        async def _(_: Any) -> None:
            set_theme(gui, dark.value)

        self._view.draw()

    # Calls of the view of the curves.

    def present(self, _: Hashable, request: Callable[[], None]) -> None:
        """Show something at once: there is one thread."""
        with self._server.viser.atomic():
            request()

    def problem(self, pair: tuple[int, int]) -> CurveProblem:
        """Return the curves of two equations."""
        return self._make(pair)
