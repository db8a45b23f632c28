"""Whatever is given to a public function, it answers or raises an error of its own."""

import inspect
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros import calibration, dynamics, spatial, trajectory
from robomech_ros.kinematics import (
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
    link_poses,
    tip_poses,
)
from robomech_ros.kinetostatics import (
    best_conditioned_posture,
    bias_acceleration,
    characteristic_length,
    condition_number,
    condition_number_gradient,
    conditioning_index,
    decoupled_jacobian,
    global_conditioning_index,
    jacobian,
    jacobian_rate,
    joint_accelerations,
    joint_rates,
    joint_torques,
    least_singular_value_gradient,
    load_reach_map,
    manipulability,
    manipulability_ellipsoid,
    manipulability_gradient,
    min_singular_value,
    nearest_singular_posture,
    planar_jacobian,
    planar_rows,
    point_jacobian,
    reach_map,
    self_motion_curve,
    singularity_free,
    singularity_report,
    task_jacobian,
    uniform_rotations,
    uniform_turns,
    wrench_from_torques,
)
from robomech_ros.robots import chain_from_dh, load_description, load_robot
from robomech_ros.trajectory import (
    PROFILES,
    Limits,
    PiecewisePolynomial,
    SpeedLimit,
    TorqueLimits,
    discretise,
    interpolant,
    nearest_turns,
    point_to_point,
    sampled_motion,
    sampled_point_to_point,
    sampled_through_points,
    spline_like,
    spline_through,
    state_to_state,
    through_points,
    time_optimal,
    torque_limited,
    verify,
    via_polynomial,
)

PATHS = "trajectory/paths/test_wrong_arguments.py"
# Of the dynamics, called by hand: a run over time, what takes another function's result, what takes
# many states.
NOT_OF_A_STATE = (
    "simulate",
    "simulate_floating",
    "move_floating_tip",
    "follow_floating_path",
    "consistent_fit",
    "torque_summary",
)

PUMA, PANDA = load_robot("puma560"), load_robot("panda")
# What searches all postures of an arm is asked for one of few joints.
PLANAR = load_robot("planar3r")
LIMITS = Limits(list("abcdef"), velocity=1.0, acceleration=2.0, jerk=3.0)
TABLE = {"a": [0.1] * 6, "b": [0.2] * 6, "alpha": [0.3] * 6}
MOTION = point_to_point([0] * 6, [0.5] * 6, limits=LIMITS)
POSES = spatial.pose_exponential(np.random.default_rng(2).normal(size=(4, 6)))
VALUES = (
    *WRONG_VALUES,
    POSES,
    1.1 * POSES,
    np.zeros((4, 4, 4)),
    np.tile(np.eye(4), (4, 1, 1)),
    np.full((4, 4, 4), np.nan),
    POSES * 1e300,
    ["0"] * 6,
    ["same"] * 6,
    [np.nan] * 6,
    [np.inf] * 6,
    [1e300] * 6,
    [[1, -1]] * 6,
    np.empty((0, 6)),
    np.empty((3, 0)),
    np.zeros(6, complex),
)


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
    found |= with_options(joint_rates, chain=PUMA, q=q, twist=q, point=[0, 0, 0])
    for function in (jacobian_rate, bias_acceleration):
        found |= with_options(function, chain=PUMA, q=q, qd=q)
    for function in (
        condition_number,
        condition_number_gradient,
        min_singular_value,
        least_singular_value_gradient,
        manipulability,
        manipulability_gradient,
    ):
        found |= with_options(function, chain=PUMA, q=q)
    found |= with_options(joint_accelerations, chain=PUMA, q=q, qd=q, twist_rate=q)
    found |= with_options(joint_torques, chain=PUMA, q=q, exerted_wrench=q)
    found |= with_options(wrench_from_torques, chain=PUMA, q=q, torques=q)
    found |= with_options(task_jacobian, chain=PUMA, q=q, mask=[True] * 6)
    for function in (decoupled_jacobian, planar_jacobian):
        found |= with_options(function, chain=PUMA, q=q)
    found |= with_options(planar_rows, chain=PUMA)
    found |= with_options(conditioning_index, chain=PUMA, part="orientation")
    ends = {"lower": q, "upper": [0.2] * 6, "most_boxes": 20}
    found |= with_options(singularity_free, chain=PUMA, **ends)
    for function in (singularity_report, nearest_singular_posture):
        found |= with_options(function, chain=PUMA, q=q, length=0.3)
    found |= with_options(characteristic_length, chain=PUMA)
    found |= with_options(best_conditioned_posture, chain=PLANAR, length=0.3)
    found |= with_options(manipulability_ellipsoid, rows=np.eye(3))
    found |= with_options(self_motion_curve, chain=PANDA, q=PANDA.home())
    found |= with_options(uniform_rotations, count=2) | with_options(
        uniform_turns, count=2, axis=[1, 0, 0]
    )
    found |= with_options(global_conditioning_index, chain=PUMA, length=0.3, postures=256)
    found |= maps() | of_dynamics() | of_calibration()
    found |= with_options(chain_from_dh, **TABLE)
    for key in ("lower", "upper", "velocity", "effort"):
        found[f"limits.{key}"] = lambda value, key=key: chain_from_dh(**TABLE, limits={key: value})
    found |= with_options(load_robot, name_or_path_or_urdf="ur5e")
    found |= {"load_description": load_description, "with_tip": PUMA.with_tip}
    found |= {"link_frame": PUMA.link_frame, "require_limits": PUMA.require_limits}
    found |= with_options(Limits, joint_names=list("abcdef"))
    found |= {
        f"{profile}.limits of {name}": lambda value, name=name, profile=profile: point_to_point(
            [0] * 6, [0.5] * 6, limits=replace(LIMITS, **{name: value}), profile=profile
        )
        for name in ("velocity", "acceleration", "jerk")
        for profile in PROFILES
    }
    for profile in PROFILES:
        good = {"q0": [0] * 6, "q1": [0.5] * 6, "limits": LIMITS, "profile": profile}
        found |= {
            f"{profile}.{name}": call for name, call in with_options(point_to_point, **good).items()
        }
    good = {"q0": [0] * 6, "q1": [0.5] * 6, "limits": LIMITS, "profile": "ruckig"}
    planned = with_options(sampled_point_to_point, period=0.1, max_points=1000, **good)
    del planned["sampled_point_to_point.max_points"]  # a node's own parameter, checked there
    found |= planned | {"sample": MOTION.sample}
    found |= with_options(state_to_state, q0=[0] * 6, q1=[0.5] * 6, limits=LIMITS)
    points = [[0.0] * 6, [0.3] * 6, [0.5] * 6]
    found |= with_options(nearest_turns, points=points, continuous=[True] * 6)
    for function in (spline_through, through_points, via_polynomial):
        found |= with_options(function, points=points, limits=LIMITS)
        found[f"{function.__name__}.goal"] = lambda value, function=function: function(
            [*points[:2], value], limits=LIMITS
        )
    found |= with_options(spline_like, q0=[0.0] * 6, q1=[0.5] * 6, limits=LIMITS)
    for name in ("times", "ends", "degree", "slopes"):
        good = {"times": [0.0, 1.0, 2.0], "ends": "clamped"}
        found[f"spline.{name}"] = lambda value, name=name, good=good: spline_through(
            points, **(good | {name: value})
        )
    planned = with_options(
        sampled_through_points,
        points=points,
        limits=LIMITS,
        profile="ruckig",
        period=0.1,
        max_points=1000,
    )
    del planned["sampled_through_points.max_points"]
    found |= planned | along_paths()
    found["verify.trajectory"] = lambda value: verify(value, LIMITS)
    found["verify.limits"] = lambda value: verify(MOTION, value)
    found["discretise.trajectory"] = lambda value: discretise(value, 0.1, 1000)
    good = {"start": [0.0] * 6, "limits": LIMITS, "period": 0.1}
    for name in good:
        found[f"sampled_motion.{name}"] = lambda value, name=name, good=good: sampled_motion(
            lambda limits: MOTION, max_points=1000, **(good | {name: value})
        )
    found["sampled_motion.planner"] = lambda value: sampled_motion(
        lambda limits: value, [0.0] * 6, LIMITS, period=0.1, max_points=1000
    )
    found["discretise.period"] = lambda value: discretise(MOTION, value, 1000)
    found |= with_options(interpolant, times=[0.0, 1.0], positions=[[0.0], [1.0]])
    for name in spatial.__all__:
        function = getattr(spatial, name)
        if not callable(function):
            continue
        arguments = inspect.signature(function).parameters.values()
        needed = [one for one in arguments if one.default is one.empty]
        count = len(needed)
        found[name] = lambda value, f=function, n=count: f(*[value] * n)
    return found


def maps():
    """Maps of two points at the most."""
    good = {"lower": [0.3, 0, 0], "upper": [0.5, 0, 0], "shape": [2, 1, 1]}
    good |= {"orientations": 1, "length": 0.3, "workers": 1}
    found = with_options(reach_map, PUMA, **good)
    del found["reach_map.progress"]  # what a caller's own function makes of its arguments
    found["load_reach_map.path"] = load_reach_map
    good |= {"shape": None, "spacing": 0.2}
    found["reach_map.spacing"] = lambda value: reach_map(PUMA, **(good | {"spacing": value}))
    return found


def of_calibration():
    """Every function of calibration: poses of a sensor at the hand's origin."""
    A = spatial.pose_exponential(np.random.default_rng(1).normal(size=(4, 6)))
    B = spatial.inverse_pose(A)
    found = with_options(calibration.next_best_pose, calibration=calibration.hand_eye(A, B))
    found |= with_options(calibration.hand_eye, robot_poses=A, sensor_poses=B)
    found |= with_options(calibration.robot_world, A=A, B=A)
    found |= with_options(calibration.relative_hand_eye, A=A, B=A)
    found |= with_options(calibration.motion_agreement, motions=np.stack((A, A)))
    functions = [one for one in calibration.__all__ if one[0].islower()]
    assert {name.split(".")[0] for name in found} == set(functions)
    return found


def of_dynamics():
    """Every function of the dynamics that takes states."""
    q = [0.1] * 6
    state = {"chain": PUMA, "q": q, "qd": q}
    good = state | {"qdd": q, "tau": q, "parameters": dynamics.body_parameters(PUMA)[1]}
    good |= {"payload": PUMA.bodies[-1], "algorithm": "inverse: newton-euler", "n": 2}
    good["path"] = MOTION
    good |= {"K": np.eye(6), "wrenches": q}
    rows = {"chain": PUMA, "times": [0.0], "q": [q], "qd": [q], "qdd": [q]}
    found = with_options(dynamics.torque_summary, **rows)
    found |= with_options(dynamics.consistent_fit, found=None)
    body = {"masses": [2.0], "inertias": np.eye(3)[None], "T": np.eye(6), "T_dot": np.eye(6)}
    body |= {"rates": q, "rotors": q, "N": np.eye(6), "N_dot": np.eye(6), "t_0": q, "t_0_dot": q}
    found |= {
        f"ConstrainedBodies.{name}": lambda value, name=name: dynamics.ConstrainedBodies(
            **(body | {name: value})
        ).inverse(q, q)
        for name in body
    }
    free = dynamics.ConstrainedBodies(**body, A=np.eye(6))
    for method in (free.inverse, free.forward, free.inertia_wrenches, free.constraint_wrenches):
        given = dict.fromkeys(inspect.signature(method).parameters, q)
        found |= with_options(method, **given)
    run = {"chain": PUMA, "q0": q, "qd0": q, "torque": None, "duration": 1e-3}
    found |= with_options(dynamics.simulate, **run, method="RK23", rtol=1e-3, atol=1e-3)
    found |= {
        "midpoint.step": lambda value: dynamics.simulate(**run, method="midpoint", step=value),
        "simulate.torques": lambda value: dynamics.simulate(**run | {"torque": lambda *_: value}),
        "simulate.event": lambda value: dynamics.simulate(**run, events=[lambda *_: value]),
    }
    for name in dynamics.__all__:
        function = getattr(dynamics, name)
        if not name[0].islower() or name in NOT_OF_A_STATE:
            continue
        needed = [
            one.name
            for one in inspect.signature(function).parameters.values()
            if one.default is one.empty
        ]
        assert set(needed) <= good.keys(), (name, needed)
        found |= with_options(function, **{key: good[key] for key in needed})
    return found


def along_paths():
    """Motions along a path that is given, and what limits them."""
    path = spline_through([[0.0] * 6, [0.3] * 6, [0.5] * 6], times=[0.0, 1.0, 2.0]).pieces
    grid = np.linspace(0.0, 2.0, 5)
    found = with_options(time_optimal, path=path, limits=LIMITS)
    found |= {
        f"smooth.{name}": call
        for name, call in with_options(
            time_optimal, path=path, limits=LIMITS, jerk_smoothing=True
        ).items()
    }
    model = {"inverse_dynamics": lambda q, qd, qdd: qdd, "effort": [9.0] * 6}
    found |= with_options(torque_limited, path=path, limits=LIMITS, **model)
    for name in ("inverse_dynamics", "friction"):
        found[f"torque_limited.{name}()"] = lambda value, name=name: torque_limited(
            path, LIMITS, **(model | {name: lambda *_: value})
        )
    found["path.breaks"] = lambda value: time_optimal(
        PiecewisePolynomial(value, path.coefficients), LIMITS
    )
    found["path.coefficients"] = lambda value: time_optimal(
        PiecewisePolynomial(path.breaks, value), LIMITS
    )
    rates = {"rate": (grid, np.ones(5)), "limit": 1.0}
    torques = {
        "coefficients": (grid, np.ones((5, 1)), np.ones((5, 1)), np.zeros((5, 1))),
        "lower": [-9.0],
        "upper": [9.0],
    }
    for name in rates:
        found[f"speed.{name}"] = lambda value, name=name: time_optimal(
            path, LIMITS, speed_limits=SpeedLimit(**(rates | {name: value}))
        )
    found["speed.rates"] = lambda value: time_optimal(
        path, LIMITS, speed_limits=SpeedLimit(lambda s: value, 1.0)
    )
    for name in torques:
        found[f"torque.{name}"] = lambda value, name=name: time_optimal(
            path, LIMITS, torque_limits=TorqueLimits(**(torques | {name: value}))
        )
    found["torque.a"] = lambda value: time_optimal(
        path, LIMITS, torque_limits=TorqueLimits(lambda s: (value, value, value), [-9.0], [9.0])
    )
    return found


def test_every_public_function_of_trajectories_is_called_here_or_with_the_paths():
    here = (Path(__file__).parent / name for name in ("test_public_functions.py", PATHS))
    called = set().union(*(re.findall(r"\w+", file.read_text()) for file in here))
    functions = [name for name in trajectory.__all__ if name[0].islower()]
    assert len(functions) > 30
    assert [name for name in functions if name not in called] == []


CALLS = calls()


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    assert not any(" inf m" in text for text in answered_or_refused(CALLS[name], VALUES))
