"""Whatever is given to a parallel robot, it answers or raises an error of its own."""

import numpy as np
import pytest
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.parallel import (
    Delta,
    Planar3RPR,
    Planar3RRR,
    Spherical3RRR,
    StewartGough,
    follow_drives,
    load_parallel,
    plan_drives,
    platform_length,
)

VALUES = (
    *WRONG_VALUES,
    [np.nan] * 6,
    [np.inf] * 3,
    [1e300] * 6,
    [1e300] * 3,
    [-1.0] * 6,
    [[1, -1]] * 6,
    [0.0] * 3,
    np.zeros((4, 4)),
    np.full((4, 4), 1e200),
    np.empty((0, 4, 4)),
    np.zeros((6, 3)),
    np.zeros(6, complex),
)
CORNERS = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
AXES = np.eye(3)


def calls():
    """Every class and method, one argument at a time."""
    found = {"load_parallel": load_parallel}
    hexapod = load_parallel("hexapod")
    T = np.eye(4)
    T[2, 3] = 0.508
    lengths = hexapod.inverse(T)
    points = {"base_points": hexapod.base_points, "platform_points": hexapod.platform_points}
    corners = {"base_points": CORNERS, "platform_points": CORNERS}
    sizes = {"base_radius": 0.2, "platform_radius": 0.05, "arm": 0.3, "forearm": 0.8}
    axes = {"base_axes": AXES, "middle_axes": AXES[[1, 2, 0]], "platform_axes": AXES[[2, 0, 1]]}
    made = {
        StewartGough: points,
        Planar3RPR: corners,
        Planar3RRR: corners | {"proximal": 1.0, "distal": 1.0},
        Delta: sizes,
        Spherical3RRR: axes,
    }
    for kind, good in made.items():
        for name, call in with_options(kind, **good).items():
            if not name.endswith(".name"):
                found[name] = call
    found |= with_options(hexapod.direct, lengths=lengths)
    found |= with_options(hexapod.follow, lengths=lengths, T=T)
    found |= {"jacobian": hexapod.jacobian, "excess": hexapod.excess, "lengths": hexapod.inverse}
    found |= {"cone_excess": hexapod.cone_excess, "cone_margins": hexapod.cone_margins}
    found["platform_length"] = platform_length
    delta = load_parallel("delta").mechanism
    home = delta.home()
    way = home[delta.drive_index] + np.linspace(0.0, 0.1, 3)[:, None]
    found |= with_options(follow_drives, mechanism=delta, drives=way, start=home)
    found |= with_options(plan_drives, mechanism=delta, points=way, start=home)
    for name in ("delta", "planar_3rrr", "planar_3rpr", "agile_eye"):
        robot = load_parallel(name)
        found[f"{name}.inverse"] = robot.inverse
        found[f"{name}.direct"] = robot.direct
        joints = [0.5, 0.5, 0.5]
        found[f"{name}.seed"] = lambda value, robot=robot, q=joints: robot.direct(q, value)
    return found


CALLS = calls()


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    answered_or_refused(CALLS[name], VALUES)
