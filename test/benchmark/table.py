"""The one table that the benchmarks print: what was measured, against what, and the target."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

HEADINGS = ("measured", "ours", "peer", "ratio", "spread", "target", "reached")


@dataclass(frozen=True)
class Row:
    """One measurement.

    Attributes
    ----------
    what : str
        What was measured.
    ours : float
        Our figure, in `unit`.
    unit : str
        Unit of `ours` and `peer`.
    peer, peer_name : float or None, str
        The peer's figure from the same run, and who the peer is.
    spread : float or None
        Relative quartile spread of our figure.
    limit : float or None
        The most that `ours` may be (in `unit`) to reach the target.
    ratio_limit : float or None
        The most that `ours / peer` may be to reach the target.
    """

    what: str
    ours: float
    unit: str = "us"
    peer: float | None = None
    peer_name: str = ""
    spread: float | None = None
    limit: float | None = None
    ratio_limit: float | None = None

    @property
    def ratio(self) -> float | None:
        """Ours over the peer's; None without a peer."""
        return self.ours / self.peer if self.peer else None

    @property
    def reached(self) -> bool | None:
        """Whether every target of the row holds; None where it has no target."""
        verdicts = []
        if self.limit is not None:
            verdicts.append(self.ours <= self.limit)
        if self.ratio_limit is not None and self.ratio is not None:
            verdicts.append(self.ratio <= self.ratio_limit)
        return all(verdicts) if verdicts else None

    @property
    def target(self) -> str:
        """The target in words."""
        parts = []
        if self.limit is not None:
            parts.append(f"<= {self.limit:g} {self.unit}")
        if self.ratio_limit is not None:
            parts.append(f"ratio <= {self.ratio_limit:g}")
        return ", ".join(parts)

    def cells(self) -> tuple[str, ...]:
        """Return the row's text, one entry for each of HEADINGS."""
        peer = f"{_number(self.peer)} {self.peer_name}" if self.peer is not None else ""
        return (
            self.what,
            f"{_number(self.ours)} {self.unit}",
            peer,
            f"{self.ratio:.2f}" if self.ratio is not None else "",
            f"{self.spread:.0%}" if self.spread is not None else "",
            self.target,
            {True: "yes", False: "NO", None: ""}[self.reached],
        )


def _number(value: float) -> str:
    """Return three significant digits without an exponent."""
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def render(title: str, rows: Iterable[Row]) -> str:
    """Return `rows` as a table of text under `title`."""
    table = [HEADINGS, *(row.cells() for row in rows)]
    widths = [max(len(cells[column]) for cells in table) for column in range(len(HEADINGS))]
    rule = tuple("-" * width for width in widths)
    padded = [
        "  ".join(text.ljust(width) for text, width in zip(cells, widths, strict=True)).rstrip()
        for cells in (table[0], rule, *table[1:])
    ]
    return "\n".join([title, *padded, ""])


def missed(rows: Iterable[Row]) -> list[Row]:
    """Return the rows whose target was not reached."""
    return [row for row in rows if row.reached is False]
