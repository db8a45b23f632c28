"""Captions below the section of a workspace, and below a map."""

from __future__ import annotations

import html

from robomech_ros.kinetostatics import ReachMap
from robomech_ros.rvs.model.reach_points import ReachPoints, scale_colours
from robomech_ros.rvs.model.workspace_views import SectionView
from robomech_ros.rvs.page.tables import SMALL, small_text

# Colours of the bar of a legend.
STEPS = 9


def section_text(view: SectionView | None, refused: str) -> str:
    """Write what the section shows, or why there is none, as HTML."""
    if refused:
        return small_text([refused, "The reach map shows what this arm reaches."])
    if view is None:
        return small_text(["Looking for the boundary ..."])
    space, wrist = view.space, bool((abs(view.in_tip) > 1e-9).any())
    what = "the centre of the wrist" if wrist else "the tip"
    joints = "the first three joints, joint 1 being free"
    if space.section.flat:
        joints = "the arm"
    if space.tip is not None:
        joints += "; each stands for a continuum"
    lines = [
        f"Postures of {joints}, at each place of {what} "
        f"{'in its plane' if space.section.flat else 'in the half-plane that it is in'}.",
        f"Reach of it: {space.least_reach:.3f} to {space.greatest_reach:.3f} m from joint 1.",
        "A click brings it there, with the present orientation. The postures listed are those of "
        "the whole arm, inside all its limits.",
    ]
    return small_text(lines, escaped=True).replace("<div ", "<div data-workspace ", 1)


def map_legend(found: ReachMap, shown: ReachPoints, measure: str) -> str:
    """Write what the colours of a map are, as HTML."""
    parts = [k / (STEPS - 1) for k in range(STEPS)]
    colours = ", ".join(f"rgb({r},{g},{b})" for r, g, b in scale_colours(parts).tolist())
    unit = f" {shown.unit}" if shown.unit == "%" else ""
    tried = len(found.request.orientations)
    of = f"{tried} orientations" if tried > 1 else "one orientation"
    title = measure if unit else f"{measure}, of {of} together"
    reached = int((found.reached > 0).sum())
    return (
        f'<div style="{SMALL}" data-reach-map><div>{html.escape(title)}</div>'
        f'<div style="height:0.8em;border-radius:2px;background:linear-gradient(90deg, {colours})">'
        '</div><div style="display:flex;justify-content:space-between">'
        f"<span>{shown.low:g}{unit}</span><span>{shown.high:g}{unit}</span></div>"
        f"<div>{reached} of {found.grid.cells} points reached by the tip, with {of} tried at each. "
        "A click on a point brings the tip there, with the present orientation.</div></div>"
    )
