"""Crossing curves in a browser: which are drawn, an estimate by a click or typed, its root."""

import html
from collections.abc import Callable, Hashable, Sequence
from typing import Any, Protocol

import numpy as np

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.rvs.model.curves.curve_drawing import (
    COLOURS,
    ROOT,
    Mark,
    draw_curves,
    place_script,
)
from robomech_ros.rvs.model.curves.curve_problems import CurveProblem, Finding, pair_of_numbers
from robomech_ros.rvs.page.tables import notice, small_text
from robomech_ros.rvs.serving.scripts import script_that_fills
from robomech_ros.typing import Array

Request = Callable[[], None]

# Label of the text field with the rough estimate; clicks on the curves write into it.
ESTIMATE = "Estimate"
_HINT = (
    "A rough estimate of a crossing, as 0.5, -1.2; a click on the curves writes it. Newton-Gauss "
    "refines it"
)
_LEGEND = "<b style='color:{colour}'>&#9473;</b> {name} = 0"


class CurveOwner(Protocol):
    """Owner of curves, on its page."""

    # Name of a root, with its article and in the plural.
    root: str = "a root"
    roots: str = "roots"

    def present(self, kind: Hashable, request: Request) -> None:
        """Run a request on the thread of the page; a newer one of its kind replaces it."""

    def problem(self, pair: tuple[int, int]) -> CurveProblem | None:
        """Return what is drawn, for two equations; None for nothing; called in ``compute``."""

    def disc(self, _: Finding) -> tuple[str, str]:
        """Return text and colour of the disc of a root; called in ``compute``."""
        return "", ROOT

    def take(self, found: Finding) -> None:
        """Do what follows from a root, nothing by default; called in ``present``."""
        return


class CurveView:
    """The curves of two equations in one browser.

    - ``compute``: runs a slow request on one thread; a newer one of its kind replaces it.
    - ``names``: names of the equations; the curves of two are drawn.
    - ``pair``: indices of the two equations that are drawn at first.
    """

    def __init__(
        self,
        gui: Any,
        owner: CurveOwner,
        compute: Callable[[Hashable, Request], None],
        names: Sequence[str],
        pair: tuple[int, int],
    ) -> None:
        self._owner, self._compute, self._names, self._pair = owner, compute, list(names), pair
        self._problem: CurveProblem | None = None
        self._curves: Sequence[Sequence[Array]] = ((), ())
        self._found: list[Finding] = []
        self._path: Array | None = None
        self._here: Array | None = None
        self.removed = False
        self._plot = gui.add_html("")
        self._estimate = gui.add_text(ESTIMATE, "", hint=_HINT)
        self._text = gui.add_html("")
        self._choices = [
            gui.add_dropdown(label, self._names, initial_value=self._names[number])
            for label, number in zip(("First curve", "Second curve"), pair, strict=True)
        ]
        self._all = gui.add_button("Mark all crossings")
        self._listen()

    @property
    def handles(self) -> tuple[Any, ...]:
        """The controls."""
        return (self._plot, self._estimate, self._text, *self._choices, self._all)

    def show(self, shown: bool) -> None:
        """Show the controls, or not."""
        for handle in self.handles:
            handle.visible = shown

    def remove(self) -> None:
        """Take the controls from the browser."""
        self.removed = True
        for handle in reversed(self.handles):
            handle.remove()

    def _listen(self) -> None:
        estimate = self._estimate

        @estimate.on_update
        async def _(event: Any) -> None:
            if event.client is not None and estimate.value.strip():
                text = estimate.value
                self._compute("estimate", lambda: self._refine(text))

        for choice in self._choices:

            @choice.on_update
            async def _(event: Any) -> None:
                if event.client is not None:
                    self.draw(self._here)

        @self._all.on_click
        async def _(_: Any) -> None:
            self._compute("all", self._mark_all)

    def draw(self, here: Array | None = None) -> None:
        """Draw the curves anew, without the crossings of the former ones.

        - ``here``: position of the mark for the present state, shape (2,); None for no mark.
        """
        self._here = here
        self._compute("draw", self._draw)

    def mark_here(self, point: Array) -> None:
        """Mark where something is now."""
        self._here = point
        self._compute("here", lambda: self._present(None))

    # Slow work, on one thread.

    def _draw(self) -> None:
        self._found, self._path, self._problem = [], None, None
        chosen = [choice.value for choice in self._choices]
        try:
            first, second = (self._names.index(value) for value in chosen)
        except ValueError:
            return
        try:
            if first == second:
                raise BadValueError("Second curve", chosen[1], "another equation than the first")
            self._problem = self._owner.problem((first, second))
            if self._problem is None:
                return
            self._curves = self._problem.source.curves()
        except RobomechError as error:
            self._present(notice([f"Refused: {error}"]))
            return
        self._pair = (first, second)
        self._present(self._legend())

    def _refine(self, text: str) -> None:
        problem = self._problem
        if problem is None:
            return
        try:
            found = problem.refine(pair_of_numbers("estimate", text, "two numbers, as 0.5, -1.2"))
        except RobomechError as error:
            self._present(self._legend() + notice([f"Refused: {error}"]))
            return
        self._path = found.path
        others = [one for one in self._found if np.abs(one.point - found.point).max() >= 1e-6]
        self._found = [*others, found]
        take = (lambda: self._owner.take(found)) if found.is_root else None
        self._present(self._legend() + small_text(self._sentences(problem, found)), take)

    def _mark_all(self) -> None:
        problem = self._problem
        if problem is None:
            return
        try:
            self._found = problem.all()
        except RobomechError as error:
            self._present(self._legend() + notice([f"Refused: {error}"]))
            return
        count, roots = len(self._found), sum(each.is_root for each in self._found)
        text = f"{counted(count, 'crossing')}: {roots} {self._owner.roots} (discs)"
        text += f", {count - roots} spurious (diamonds)." if problem.others else "."
        self._present(self._legend() + small_text([text]))

    def _present(self, text: str | None, take: Request | None = None) -> None:
        """Show the picture, with another text unless it is None."""
        picture = "" if self._problem is None else self._picture(self._problem)

        def shown() -> None:
            if self.removed:
                return
            self._plot.content = picture
            if text is not None:
                self._text.content = text
            if take is not None:
                take()

        # A picture of where the arm is takes nothing from what a sentence says.
        self._owner.present("here" if text is None else "found", shown)

    def _picture(self, problem: CurveProblem) -> str:
        marks = []
        for found in self._found:
            if found.is_root:
                marks.append(Mark("root", found.point, *self._owner.disc(found)))
            else:
                marks.append(Mark("spurious", found.point))
        if self._here is not None:
            marks.append(Mark("here", self._here))
        script = place_script(problem.axes) + script_that_fills(ESTIMATE)
        return draw_curves(problem.axes, self._curves, marks, self._path, script)

    def _legend(self) -> str:
        names = (html.escape(self._names[number]) for number in self._pair)
        parts = [
            _LEGEND.format(colour=colour, name=name)
            for colour, name in zip(COLOURS, names, strict=True)
        ]
        return small_text(["&emsp;".join(parts)], escaped=True)

    def _sentences(self, problem: CurveProblem, found: Finding) -> list[str]:
        unit = f" {problem.axes[0].unit}" if problem.axes[0].unit else ""
        values = ", ".join(
            f"{axis.name} = {value:.6f}{' ' * bool(axis.unit)}{axis.unit}"
            for axis, value in zip(problem.axes, found.point.tolist(), strict=True)
        )
        lengths = np.linalg.norm(np.diff(found.path, axis=0), axis=1).tolist()
        steps = ", ".join(f"{length:.0e}" for length in lengths)
        sentences = [f"{values}, after {counted(len(lengths), 'step')}: {steps}{unit}."]
        left = f"the other {problem.others} equations leave {found.left_over:.2g} of their size."
        if problem.others == 1:
            left = f"the other equation leaves {found.left_over:.2g} of its size."
        if not found.is_root:
            return [*sentences, f"Spurious: {left}"]
        root = self._owner.root.capitalize()
        sentences.append(f"{root}: {left}" if problem.others else f"{root}.")
        crossing = f"The curves cross at {found.angle:.3g} rad"
        if found.condition is not None:
            crossing += f"; condition number {found.condition:.3g}"
        return [*sentences, f"{crossing}."]
