"""Whatever is given to a public function, it answers or raises an error of its own."""

import inspect
import warnings

import numpy as np
import pytest

from robomech_ros import spatial
from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import (
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
    link_poses,
    tip_poses,
)
from robomech_ros.kinetostatics import jacobian, point_jacobian
from robomech_ros.robots import chain_from_dh, load_description, load_robot
from robomech_ros.trajectory import (
    PROFILES,
    Limits,
    discretise,
    interpolant,
    point_to_point,
    sampled_point_to_point,
    spline_through,
    through_points,
    verify,
    via_polynomial,
)

PUMA, PANDA = load_robot("puma560"), load_robot("panda")
LIMITS = Limits(list("abcdef"), velocity=1.0, acceleration=2.0, jerk=3.0)
TABLE = {"a": [0.1] * 6, "b": [0.2] * 6, "alpha": [0.3] * 6}
MOTION = point_to_point([0] * 6, [0.5] * 6, limits=LIMITS)
VALUES = (
    None,
    True,
    "",
    "x",
    b"x",
    -1,
    0,
    1.5,
    np.nan,
    np.inf,
    1e300,
    10**400,
    2 + 3j,
    object(),
    int,
    {},
    {"a": 1},
    {1, 2},
    [],
    [None],
    ["a"],
    ["0"] * 6,
    ["same"] * 6,
    [np.nan] * 6,
    [np.inf] * 6,
    [1e300] * 6,
    [[1, 2], [3]],
    [[1, -1]] * 6,
    np.array(3.0),
    np.empty((0, 6)),
    np.empty((3, 0)),
    np.zeros((2, 2, 2)),
    np.zeros(6, complex),
    np.full((4, 4), np.nan),
    np.full((4, 4), 1e300),
    np.zeros((4, 4)),
)


def with_options(function, *given, **good):
    """Calls of a function with each of its arguments by name replaced."""
    return {
        f"{function.__name__}.{name}": lambda value, name=name: function(
            *given, **(good | {name: value})
        )
        for name, parameter in inspect.signature(function).parameters.items()
        if parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY)
        and list(inspect.signature(function).parameters).index(name) >= len(given)
    }


def calls():
    """Every public function of the core, one argument at a time."""
    q = [0.1] * 6
    T = forward_kinematics(PUMA, q)
    found = {}
    for chain in (PUMA, PANDA):
        found |= {
            f"{chain.name}.{name}": call
            for name, call in (
                with_options(inverse_kinematics, chain, T=T)
                | with_options(inverse_kinematics_batch, chain, T=T[None])
            ).items()
        }
    found |= with_options(forward_kinematics, chain=PUMA, q=q)
    found |= with_options(link_poses, chain=PUMA, q=q)
    found |= with_options(tip_poses, chain=PUMA, q=[q])
    found |= with_options(jacobian, chain=PUMA, q=q)
    found |= with_options(point_jacobian, chain=PUMA, q=q, point=[0, 0, 0])
    found |= with_options(chain_from_dh, **TABLE)
    for key in ("lower", "upper", "velocity", "effort"):
        found[f"limits.{key}"] = lambda value, key=key: chain_from_dh(**TABLE, limits={key: value})
    found |= with_options(load_robot, name_or_path_or_urdf="ur5e")
    found |= {"load_description": load_description, "with_tip": PUMA.with_tip}
    found |= {"link_frame": PUMA.link_frame, "require_limits": PUMA.require_limits}
    found |= with_options(Limits, joint_names=list("abcdef"))
    for profile in PROFILES:
        good = {"q0": [0] * 6, "q1": [0.5] * 6, "limits": LIMITS, "profile": profile}
        found |= {
            f"{profile}.{name}": call for name, call in with_options(point_to_point, **good).items()
        }
    good = {"q0": [0] * 6, "q1": [0.5] * 6, "limits": LIMITS, "profile": "ruckig"}
    planned = with_options(sampled_point_to_point, period=0.1, max_points=1000, **good)
    del planned["sampled_point_to_point.max_points"]  # a node's own parameter, checked there
    found |= planned | {"sample": MOTION.sample}
    points = [[0.0] * 6, [0.3] * 6, [0.5] * 6]
    for function in (spline_through, through_points, via_polynomial):
        found |= with_options(function, points=points, limits=LIMITS)
    for name in ("times", "ends", "degree", "slopes"):
        good = {"times": [0.0, 1.0, 2.0], "ends": "clamped"}
        found[f"spline.{name}"] = lambda value, name=name, good=good: spline_through(
            points, **(good | {name: value})
        )
    found["verify.trajectory"] = lambda value: verify(value, LIMITS)
    found["verify.limits"] = lambda value: verify(MOTION, value)
    found["discretise.period"] = lambda value: discretise(MOTION, value, 1000)
    found |= with_options(interpolant, times=[0.0, 1.0], positions=[[0.0], [1.0]])
    for name in spatial.__all__:
        function = getattr(spatial, name)
        arguments = inspect.signature(function).parameters.values()
        needed = [one for one in arguments if one.default is one.empty]
        count = len(needed)
        found[name] = lambda value, f=function, n=count: f(*[value] * n)
    return found


CALLS = calls()


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    for value in VALUES:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                CALLS[name](value)
            except RobomechError as error:
                assert str(error) and " inf m" not in str(error), value
