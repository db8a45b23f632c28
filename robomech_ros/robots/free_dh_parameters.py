"""Denavit-Hartenberg parameters that the joint axes leave free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import check_kind, of_shape, shaped_array
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.robots.dh_recovery import INTERSECTING, PARALLEL_SINE
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.spatial.arrays import listed


class DHAmbiguity(NamedTuple):
    """Free parameters of a table: other values describe the same arm.

    Attributes
    ----------
    kind : {"first frame", "parallel", "coincident", "meeting", "prismatic", "last frame"}
        Why they are free.
    parameters : tuple of str
        Such as ``b_2``, counted from 1.
    reason : str
        Which axes, and how the parameters may change together.
    """

    kind: str
    parameters: tuple[str, ...]
    reason: str


def dh_ambiguities(table: DHTable) -> tuple[DHAmbiguity, ...]:
    """Name the parameters of a table that the axes of the joints do not determine.

    Skew axes have one common normal, which fixes all parameters between them.

    Parameters
    ----------
    table : DHTable
        As from `dh_from_axes` or `dh_from_chain`.

    Returns
    -------
    tuple of DHAmbiguity
        From the first frame to the last.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.2.

    Examples
    --------
    >>> from robomech_ros.robots import dh_ambiguities, load_robot
    >>> found = dh_ambiguities(load_robot("puma560").dh)
    >>> found[2].kind, found[2].parameters
    ('parallel', ('b_2', 'b_3'))
    """
    check_kind("table", table, DHTable, "a DHTable")
    n = len(listed("a", table.a, "a number for each joint"))
    if not n:
        raise BadValueError("number of joints", n, "1 or more")
    for name in ("a", "b", "alpha"):
        shaped_array(name, getattr(table, name), (n,))
    of_shape("types", np.asarray(table.types), (n,))
    reason = (
        "no axis precedes axis 1: frame 1 may slide along it and turn about it, because the base"
    )
    found = [DHAmbiguity("first frame", ("b_1", "theta_1"), f"{reason} transform compensates")]
    for i in range(1, n + 1):
        if table.types[i - 1] == PRISMATIC:
            found.append(_sliding(i))
        if i < n:
            found += _between(table, i)
    reason = f"no axis follows axis {n}: frame {n + 1} is any frame, with another tool"
    last = (f"a_{n}", f"b_{n}", f"alpha_{n}", f"theta_{n}")
    return (*found, DHAmbiguity("last frame", last, reason))


def _sliding(i: int) -> DHAmbiguity:
    before = (f"a_{i - 1}", f"b_{i - 1}") if i > 1 else ()
    reason = f"joint {i} slides: only the direction of its axis counts, not its position"
    return DHAmbiguity("prismatic", (*before, f"a_{i}", f"b_{i}"), reason)


def _between(table: DHTable, i: int) -> list[DHAmbiguity]:
    """Return what is free between axes i and i + 1."""
    alpha, axes = float(table.alpha[i - 1]), f"axes {i} and {i + 1}"
    turns, slides = (f"theta_{i}", f"theta_{i + 1}"), (f"b_{i}", f"b_{i + 1}")
    sign = "+" if np.cos(alpha) > 0.0 else "-"
    meets = abs(float(table.a[i - 1])) <= INTERSECTING
    if abs(np.sin(alpha)) > PARALLEL_SINE:
        if not meets:
            return []
        reason = (
            f"{axes} meet: x_{i + 1} may point either way, with the other sign of alpha_{i} "
            f"and half a turn more of theta_{i} and theta_{i + 1}"
        )
        return [DHAmbiguity("meeting", (f"alpha_{i}", *turns), reason)]
    only = f"only b_{i} {sign} b_{i + 1} counts"
    if not meets:
        reason = f"{axes} are parallel: their common normal may be anywhere along them, {only}"
        return [DHAmbiguity("parallel", slides, reason)]
    reason = f"{axes} are one line: {only}, and only theta_{i} {sign} theta_{i + 1}"
    return [DHAmbiguity("coincident", (*slides, *turns), reason)]
