"""Chains from Denavit-Hartenberg parameters, and the parameters of any chain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import MOST_JOINTS, PRISMATIC, REVOLUTE, pack_chain
from robomech_ros.robots.dh_recovery import recover_dh, table_of_axes
from robomech_ros.robots.dh_table import DHTable, implausible_angles, link_transforms
from robomech_ros.robots.documents.reported_notes import report_once
from robomech_ros.robots.drives import Drive
from robomech_ros.robots.entry_checks import check_name, checked_entries
from robomech_ros.robots.limit_arrays import LARGEST_ANGLE, limit_arrays
from robomech_ros.robots.link_frames import LinkFrame
from robomech_ros.spatial import as_pose
from robomech_ros.spatial.arrays import listed, real_array
from robomech_ros.typing import Array, IntArray

_TYPE_NAMES = {"r": REVOLUTE, "p": PRISMATIC, "revolute": REVOLUTE, "prismatic": PRISMATIC}


def chain_from_dh(
    a: ArrayLike,
    b: ArrayLike,
    alpha: ArrayLike,
    theta: ArrayLike | None = None,
    *,
    types: str | Sequence[str | int] | None = None,
    base: ArrayLike | None = None,
    tool: ArrayLike | None = None,
    limits: Mapping[str, ArrayLike] | ArrayLike | None = None,
    name: str = "robot",
    joint_names: Sequence[str] | None = None,
    base_link: str = "base_link",
    tip_link: str = "tool0",
    bodies: Sequence[Body | None] | None = None,
    drives: Sequence[Drive] | None = None,
) -> SerialChain:
    """Make a chain from Denavit-Hartenberg parameters.

    Parameters
    ----------
    a, b : array_like, shape (n,)
        Length and offset of each link (m).
    alpha : array_like, shape (n,)
        Twist of each link (rad).
    theta : array_like, shape (n,), optional
        Offsets added to the variables of revolute joints, angles of prismatic ones (rad).
        Default 0.
    types : str or sequence, optional
        ``R`` or ``revolute`` (0) and ``P`` or ``prismatic`` (1) for each joint, in capitals or
        not, for example ``"RRPRRR"``; default all revolute.
    base, tool : array_like, shape (4, 4), optional
        First frame in the base link and tip link in the last frame; a rotation off by rounding
        is made orthogonal.  Default identity.
    limits : mapping or array_like, optional
        Either pairs of position limits, shape (n, 2), or a mapping of ``lower``, ``upper``,
        ``velocity``, ``acceleration``, ``jerk``, ``effort`` to arrays of shape (n,) or to one
        number for all joints; None in the place of a number is no limit.
    name, joint_names, base_link, tip_link : optional
        Names; joints are ``joint_1`` .. ``joint_n`` unless given.
    bodies : sequence of Body or None, optional
        What moves with each joint, in frame i + 1 of the table.  Default unknown.
    drives : sequence of Drive, optional
        Friction and rotor of each joint.  Default none.

    Returns
    -------
    SerialChain
        Its links are ``base_link``, ``link_1`` .. ``link_n`` (frame i + 1 of the table) and
        ``tip_link``.

    See Also
    --------
    DHTable : the formula.
    load_robot : from a file.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.robots import chain_from_dh
    >>> arm = chain_from_dh(a=[0.5, 0.4], b=[0.0, 0.0], alpha=[0.0, 0.0])
    >>> np.round(forward_kinematics(arm, [0.0, np.pi / 2.0])[:3, 3], 6)
    array([0.5, 0.4, 0. ])
    """
    a = _row("a", a)
    n = len(a)
    if n == 0:
        raise WrongSizeError("a", 0, "at least 1")
    b, alpha = _row("b", b, n), _row("alpha", alpha, n)
    theta = np.zeros(n) if theta is None else _row("theta", theta, n)
    kinds, names = _joint_types(types, n), _names(joint_names, n)
    for note in (
        *implausible_angles("alpha", alpha.tolist(), names),
        *implausible_angles("theta", theta.tolist(), names),
    ):
        report_once(note)
    table = DHTable(a, b, alpha, theta, _pose("base", base), _pose("tool", tool), kinds)
    links = link_transforms(table)
    transforms = np.concatenate((table.base[None], links))
    transforms[n] = links[n - 1] @ table.tool
    given = checked_entries("bodies", () if bodies is None else bodies, Body | None, n)
    moved = (body and body.expressed_in(T) for body, T in zip(given, links, strict=False))
    return SerialChain(
        name=name,
        base=base_link,
        tip=tip_link,
        joint_names=names,
        types=kinds,
        packed=pack_chain(transforms, kinds),
        frames=_frames(base_link, tip_link, links, transforms[n]),
        dh_given=table,
        bodies=tuple(moved),
        drives=checked_entries("drives", () if drives is None else drives, Drive, n),
        **limit_arrays(limits, n),
    )


def _frames(base_link: str, tip_link: str, links: Array, last: Array) -> tuple[LinkFrame, ...]:
    """List the frames of base, links and tip, whose pose behind the last joint is ``last``."""
    n = len(links)
    frames = [LinkFrame(base_link, 0, np.eye(4))]
    for i in range(n):
        frames.append(LinkFrame(f"link_{i + 1}", i + 1, links[i], frames[-1].name))
    frames.append(LinkFrame(tip_link, n, last, frames[-1].name))
    check_name("base_link", base_link)
    check_name("tip_link", tip_link)
    links_between = [frame.name for frame in frames[1:-1]]
    if base_link == tip_link or base_link in links_between or tip_link in links_between:
        expected = f"names that differ from each other and from {', '.join(links_between)}"
        raise BadValueError("base_link and tip_link", (base_link, tip_link), expected)
    return tuple(frames)


def dh_from_chain(chain: SerialChain) -> DHTable:
    """Recover Denavit-Hartenberg parameters of any chain of revolute and prismatic joints.

    Where the parameters are not unique (parallel or coincident axes, the place of a prismatic
    axis, the first and the last frame) the choice is the one with the fewest non-zero entries:
    the common normal through the frame before, and a first frame as near the base as it can be.

    Parameters
    ----------
    chain : SerialChain
        With at least one joint.

    Returns
    -------
    DHTable
        Its pose equals the chain's for every q.  Axes at an angle below
        ``tolerances.PARALLEL_SINE`` count as parallel.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.2.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.robots import dh_from_chain, load_robot
    >>> table = dh_from_chain(load_robot("ur5e"))
    >>> np.round(table.a, 4) + 0.0
    array([0.    , 0.425 , 0.3922, 0.    , 0.    , 0.    ])
    >>> np.round(table.b, 4) + 0.0
    array([0.1625, 0.    , 0.    , 0.1333, 0.0997, 0.0996])
    """
    if not isinstance(chain, SerialChain) or chain.n == 0:
        raise BadValueError("chain", chain, "a SerialChain with at least one joint")
    chain.require_uncoupled()
    return recover_dh(chain.packed)


def _row(what: str, value: ArrayLike, n: int | None = None) -> Array:
    row = real_array(what, value)
    if row.ndim != 1:
        raise WrongSizeError(what, row.shape, "(n,)" if n is None else (n,))
    if n is not None and len(row) != n:
        raise WrongSizeError(what, len(row), n)
    if not np.isfinite(row).all():
        raise NonFiniteError(what, row)
    largest, unit = (LARGEST_LENGTH, "m") if what in "ab" else (LARGEST_ANGLE, "rad")
    for k in np.flatnonzero(np.abs(row) > largest):
        raise BadValueError(f"{what}[{k}]", float(row[k]), f"at most {largest:g} {unit}")
    return row


def _pose(what: str, value: ArrayLike | None) -> Array:
    if value is None:
        return np.eye(4)
    pose = real_array(what, value)
    if pose.shape != (4, 4):
        raise WrongSizeError(what, pose.shape, (4, 4))
    return as_pose(pose, what=what)


def _joint_types(types: str | Sequence[str | int] | None, n: int) -> IntArray:
    if types is None:
        return np.zeros(n, dtype=np.int64)
    expected = "R (revolute) or P (prismatic) for each joint, as in 'RRP' or ['R', 'R', 'P']"
    entries = listed("types", list(types) if isinstance(types, str) else types, expected)
    if len(entries) != n:
        raise WrongSizeError("types", len(entries), f"{n}: {expected}")
    return np.array([_joint_type(entry) for entry in entries], dtype=np.int64)


def _joint_type(entry: object) -> int:
    if isinstance(entry, str) and entry.lower() in _TYPE_NAMES:
        return _TYPE_NAMES[entry.lower()]
    numbers = isinstance(entry, int | np.integer) and not isinstance(entry, bool)
    if not numbers or entry not in (REVOLUTE, PRISMATIC):
        raise BadValueError("joint type", entry, "R (revolute) or P (prismatic)")
    return int(entry)


def _names(names: Sequence[str] | None, n: int) -> tuple[str, ...]:
    if names is None:
        return tuple(f"joint_{i + 1}" for i in range(n))
    given = listed("joint_names", names, f"a list of {counted(n, 'name')}")
    if len(given) != n:
        raise WrongSizeError("joint_names", len(given), n)
    return given


def dh_from_axes(points: ArrayLike, directions: ArrayLike) -> DHTable:
    """Return the Denavit-Hartenberg table of revolute joints whose axes are given as lines.

    The lines are those of a drawing or a measurement, in the posture in which all joint values
    are 0.  Where parameters are not unique (parallel and coincident axes, the first and the last
    frame), they are chosen as :func:`dh_from_chain` does; the last frame is that of the last joint.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        A point of each axis, in the base (m).
    directions : array_like, shape (n, 3)
        Directions of positive rotation, of any length, in the base.

    Returns
    -------
    DHTable
        With ``base``, the pose of frame 1; ``tool`` is the identity.  Axes at an angle below
        1e-8 rad count as parallel.

    Raises
    ------
    BadValueError
        Naming the argument, and the axis without a direction.

    See Also
    --------
    chain_from_dh : a chain, with ``table.a``, ``table.b``, ``table.alpha``, ``table.theta`` and
        ``base=table.base``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.2.

    Examples
    --------
    Two axes that cross at right angles, and one parallel to the second, 0.4 m away:

    >>> from robomech_ros.robots import dh_from_axes
    >>> points = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.3], [0.4, 0.0, 0.3]]
    >>> table = dh_from_axes(points, [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, -1.0, 0.0]])
    >>> table.a.tolist(), table.b.tolist(), table.alpha.round(4).tolist()
    ([0.0, 0.4, 0.0], [0.3, 0.0, 0.0], [1.5708, 0.0, 0.0])
    """
    lines = real_array("points", points), real_array("directions", directions)
    for what, given in zip(("points", "directions"), lines, strict=True):
        if given.ndim != 2 or given.shape[1] != 3 or not 0 < len(given) <= MOST_JOINTS:
            raise WrongSizeError(what, given.shape, f"(n, 3), n from 1 to {MOST_JOINTS}")
        if not np.isfinite(given).all():
            raise NonFiniteError(what, given)
    origins, axes = lines
    if len(origins) != len(axes):
        raise WrongSizeError("directions", axes.shape, origins.shape)
    if np.abs(origins).max() > LARGEST_LENGTH:
        raise BadValueError("points", float(np.abs(origins).max()), f"at most {LARGEST_LENGTH:g} m")
    longest = np.abs(axes).max(axis=1, keepdims=True)
    for k in np.flatnonzero(longest == 0.0):
        raise BadValueError(f"directions[{k}]", axes[k].tolist(), "a non-zero vector")
    # By the largest entry first, so that no square overflows or vanishes.
    axes = axes / longest
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return table_of_axes(axes, origins, None, np.full(len(axes), REVOLUTE))
