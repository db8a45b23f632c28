"""det J21 without the factors of it that depend on one joint alone."""

import numpy as np

from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.numerics.nonlinear import bisected
from robomech_ros.typing import Array, BoolArray

# Values of a joint between which it is looked for a change of sign.
_LOOKS = 1280
_BISECTIONS = 52


class DeflatedDeterminant:
    """det J21 without those of its factors that vanish at a value of one joint alone.

    Where axes 2 and 3 are parallel the elbow is such a factor; the lines on which it vanishes may
    be so near to the other branches that no grid parts them.
    """

    def __init__(self, section: WorkspaceSection) -> None:
        self.section = section
        self.lines = [(j, value) for j in (1, 2) for value in _singular_values(section, j)]

    def positive(self, u: Array, v: Array) -> BoolArray:
        """Tell its sign, which lines (of a grid) do not hide, shape (...)."""
        values = self.section.determinant(u, v)
        for joint, value in self.lines:
            values = values * self._factor(joint, value, u, v)[0]
        return values >= 0.0

    def gradient(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return its value and derivatives, shape (...) each; huge on the lines themselves."""
        f, fu, fv = self.section.determinant_gradient(u, v)
        for joint, value in self.lines:
            e, slope = self._factor(joint, value, u, v)
            e = np.where(np.abs(e) < 1e-12, 1e-12, e)
            f = f / e
            if joint == 1:
                fu, fv = (fu - f * slope) / e, fv / e
            else:
                fu, fv = fu / e, (fv - f * slope) / e
        return f, fu, fv

    def _factor(self, joint: int, value: float, u: Array, v: Array) -> tuple[Array, Array]:
        x = (u if joint == 1 else v) - value
        if self.section.slides[joint]:
            return x, np.ones_like(x)
        # One zero in a turn; the product of an even number of them is the same after a turn.
        return 2.0 * np.sin(0.5 * x), np.cos(0.5 * x)


def _singular_values(section: WorkspaceSection, joint: int) -> list[float]:
    """Find the values of a joint at which the arm is singular whatever the other's value."""
    lower, upper = section.lower[joint], section.upper[joint]
    values = np.linspace(lower, upper, _LOOKS + 1)
    values += 0.1234 * (values[1] - values[0]) if section.round[joint] else 0.0
    other = 3 - joint
    span = section.upper[other] - section.lower[other]
    across = section.lower[other] + span * np.array((0.137, 0.351, 0.618, 0.871))

    def products(x: Array) -> Array:
        grid = np.meshgrid(x, across, indexing="ij")
        u, v = grid if joint == 1 else grid[::-1]
        return section.determinant(u, v)

    f = products(values)
    scale = np.abs(f).max(axis=0)
    change = np.flatnonzero(((f[:-1] > 0.0) != (f[1:] > 0.0)).all(axis=1))
    found = []
    for k in change:
        positive = f[k, 0] > 0.0

        def before(x: float, positive: bool = positive) -> bool:
            return bool((products(np.array([x]))[0, 0] > 0.0) == positive)

        low, _ = bisected(values[k], values[k + 1], before, _BISECTIONS)
        if (np.abs(products(np.array([low]))[0]) <= 1e-13 * scale).all():
            found.append(float(low))
    return [] if section.round[joint] and len(found) % 2 else found
