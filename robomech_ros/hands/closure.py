"""Check that contacts hold an object against every load."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robomech_ros._kernels.hands.force_closure import CLOSED, closed
from robomech_ros.hands.contacts import Contact, as_contacts, rows_of
from robomech_ros.typing import Array


def is_force_closed(contacts: Sequence[Contact]) -> bool:
    """Return whether contacts can balance every load by forces strictly inside their cones.

    Then, and only then, the grasp matrix has full rank and some internal forces are inside all
    cones.  Two frictionless contacts opposite each other are not closed, nor is a grasp that loses
    closure by any change of its friction, however small.

    Parameters
    ----------
    contacts : sequence of Contact

    Returns
    -------
    bool
        A grasp of which the quality is below 1e-9 counts as open.

    References
    ----------
    Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation, CRC Press 1994,
    section 5.4.  The decrement of Newton's method as a proof: Nesterov and Nemirovskii,
    Interior-Point Polynomial Algorithms in Convex Programming, SIAM 1994, section 2.2.

    Examples
    --------
    >>> from robomech_ros.hands import Contact, is_force_closed
    >>> pair = [([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), ([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0])]
    >>> is_force_closed([Contact(p, n, "point", 0.5) for p, n in pair])
    False
    >>> is_force_closed([Contact(p, n, "soft", 0.5, torsional=0.1) for p, n in pair])
    True
    """
    given = as_contacts(contacts)
    return _surrounds(rows_of(given), given[0].planar)


def is_form_closed(contacts: Sequence[Contact]) -> bool:
    """Return whether contacts hold an object by their normals alone, to first order.

    That takes seven contacts in space and four in the plane.

    Parameters
    ----------
    contacts : sequence of Contact
        Their friction does not count.

    References
    ----------
    Reuleaux 1876; Lakshminarayana, Mechanics of Form Closure, ASME 78-DET-32, 1978.
    """
    given = as_contacts(contacts)
    rows = rows_of(given)
    rows[:, 12:] = 0.0
    return _surrounds(rows, given[0].planar)


def _surrounds(rows: Array, planar: bool) -> bool:
    """Return whether the wrenches of contacts surround the origin."""
    d = 3 if planar else 6
    middle = rows[:, :3].mean(axis=0)
    offset = rows[:, :3] - middle
    length = float(np.sqrt((offset * offset).sum(axis=1).max())) or 1.0
    return bool(
        closed(rows, middle, length, planar, np.empty((len(rows), 4, d)), np.empty(d)) == CLOSED
    )
