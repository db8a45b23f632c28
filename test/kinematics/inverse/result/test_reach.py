"""How far a target is out of reach, against searches by other means and against geometry."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.inverse.families.iterative_search import REACH_ATTEMPTS
from robomech_ros.kinematics.inverse.request.task import FULL_TASK
from robomech_ros.kinematics.inverse.result.reach import (
    REACH_STARTS,
    distance_inside_limits,
    reach_gap,
)
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, load_robot

ROBOTS = ("puma560", "ur5e", "panda", "stanford", "scara", "planar3r")


def pose_at(position, rng=None):
    T = np.eye(4)
    T[:3, 3] = position
    if rng is not None:
        T[:3, :3] = Rotation.random(rng=rng).as_matrix()
    return T


def least_distance(chain, point, rng, starts=15):
    """The least distance over all joint values by a quasi-Newton method from random starts."""

    def value_and_gradient(q):
        offset = forward_kinematics(chain, q)[:3, 3] - point
        return 0.5 * offset @ offset, jacobian(chain, q)[3:].T @ offset

    best = math.inf
    for _ in range(starts):
        start = rng.uniform(-np.pi, np.pi, chain.n)
        found = minimize(
            value_and_gradient, start, jac=True, method="BFGS", options={"gtol": 1e-11}
        )
        best = min(best, found.fun)
        if best < 1e-14:
            # In reach, as no further start could make it more.
            break
    return math.sqrt(2.0 * best)


def least_distance_inside(chain, point, rng, starts=8):
    """The least distance inside the limits by a quasi-Newton method for bounds."""

    def value_and_gradient(q):
        offset = forward_kinematics(chain, q)[:3, 3] - point
        return 0.5 * offset @ offset, jacobian(chain, q)[3:].T @ offset

    lower, upper = np.clip((chain.lower, chain.upper), -2.0 * np.pi, 2.0 * np.pi)
    found = [
        minimize(
            value_and_gradient,
            rng.uniform(lower, upper),
            jac=True,
            method="L-BFGS-B",
            bounds=list(zip(lower, upper, strict=True)),
            options={"ftol": 1e-13, "gtol": 1e-8},
        ).fun
        for _ in range(starts)
    ]
    return math.sqrt(2.0 * min(found))


@pytest.mark.parametrize("name", ROBOTS)
def test_issue_12_the_amount_respects_the_limits(name):
    """The SCARA reported 1.313 m instead of 1.371 m: the ends of its slide were ignored."""
    chain, rng, seen = load_robot(name), np.random.default_rng(7), set()
    for point in ((0.0, 0.0, -3.0), (-0.5, -2.0, 0.5), (-1.5, 0.5, -1.0), (0.3, 0.2, 3.0)):
        T = pose_at(point)
        result = inverse_kinematics(chain, T)
        free = inverse_kinematics(chain, T, respect_limits=False)
        if free.status is not Status.OUT_OF_REACH:
            continue
        aside = reach_gap(chain, T).distance
        inside = least_distance_inside(chain, point, rng)
        found = distance_inside_limits(chain, T, FULL_TASK, aside)
        assert found == pytest.approx(inside, abs=2e-6) and found >= aside - 1e-9
        limits_matter = found > aside * (1.0 + 1e-5)
        seen.add(limits_matter)
        said = f"out of reach by {found:.6g} m"
        if limits_matter:
            said += f" inside the joint limits, {aside:.6g} m without them"
        assert said in result.reason
        assert f"out of reach by {aside:.6g} m" in free.reason and "limits" not in free.reason
    assert True in seen or name in ("ur5e", "planar3r")


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_distance_agrees_with_another_search(name):
    chain = load_robot(name)
    rng = np.random.default_rng(1)
    for scale in np.repeat([0.05, 0.3, 1.0, 3.0], 3):
        point = rng.normal(size=3) * scale
        if chain.n == 3:
            point[2] *= rng.integers(0, 2)
        gap = reach_gap(chain, pose_at(point, rng))
        assert gap.distance == pytest.approx(least_distance(chain, point, rng), abs=1e-6)


@pytest.mark.parametrize("name", ROBOTS)
def test_nothing_is_missing_to_a_pose_of_the_arm(name):
    chain = load_robot(name)
    for q in np.random.default_rng(2).uniform(-np.pi, np.pi, (30, chain.n)):
        gap = reach_gap(chain, forward_kinematics(chain, q))
        assert gap.distance == 0.0
        assert gap.orientation_error < 1e-5


def planar_arm(*links):
    return chain_from_dh(links, [0.0] * len(links), [0.0] * len(links))


@pytest.mark.parametrize(
    ("links", "radius", "expected"),
    [
        ((1.0, 0.8, 0.4), 3.0, 0.8),
        ((1.0, 0.8, 0.4), 0.1, 0.0),
        ((1.0, 0.3, 0.2), 0.1, 0.4),
        ((1.0, 0.3, 0.2), 0.0, 0.5),
        ((1.0, 0.3, 0.2), 0.5, 0.0),
        ((1.0, 0.3, 0.2), 1.5, 0.0),
        ((0.2, 1.0, 0.3), 0.25, 0.25),
    ],
)
def test_planar_arms_and_the_hole_in_their_middle(links, radius, expected):
    for angle in (0.0, 0.7, math.pi):
        point = [radius * math.cos(angle), radius * math.sin(angle), 0.0]
        gap = reach_gap(planar_arm(*links), pose_at(point))
        assert gap.distance == pytest.approx(expected, abs=1e-6)


def test_height_that_a_planar_arm_has_not():
    gap = reach_gap(planar_arm(1.0, 0.8, 0.4), pose_at([1.0, 0.5, 0.25]))
    assert gap.distance == pytest.approx(0.25, abs=1e-9) and math.isnan(gap.orientation_error)


def test_orientation_that_a_planar_arm_has_not():
    """Tilted about an axis in the plane: the tilt is what is missing."""
    chain = planar_arm(1.0, 0.8, 0.4)
    T = forward_kinematics(chain, [0.3, 0.7, -0.4])
    T[:3, :3] = T[:3, :3] @ Rotation.from_rotvec([0.4, 0.0, 0.0]).as_matrix()
    gap = reach_gap(chain, T)
    assert gap.distance == 0.0 and gap.orientation_error == pytest.approx(0.4, abs=1e-5)


def test_orientation_that_a_planar_arm_has_not_at_this_place():
    """Near the outer boundary only some directions of the last link remain."""
    chain = planar_arm(1.0, 0.8, 0.4)
    distance, wanted = 2.1, 2.5
    # The last joint must be within 1.8 m of the base: the law of cosines bounds the direction.
    bound = math.acos((distance**2 + 0.4**2 - 1.8**2) / (2.0 * distance * 0.4))
    T = pose_at([distance, 0.0, 0.0])
    T[:3, :3] = Rotation.from_rotvec([0.0, 0.0, wanted]).as_matrix()
    gap = reach_gap(chain, T)
    assert gap.distance == 0.0
    assert gap.orientation_error == pytest.approx(wanted - bound, abs=1e-4)


@pytest.mark.parametrize("name", ["ur5e", "panda"])
def test_least_orientation_error_is_not_beaten(name):
    """No posture that a constrained optimiser finds at the position is nearer."""
    chain = load_robot(name)
    rng = np.random.default_rng(3)
    direction = np.array([0.6, 0.0, 0.8])
    reach = 9.0 - reach_gap(chain, pose_at(9.0 * direction)).distance
    compared = 0
    while compared < 3:
        T = pose_at(0.97 * reach * direction, rng)
        gap = reach_gap(chain, T)
        assert gap.distance == 0.0
        if gap.orientation_error < 0.01:
            continue
        compared += 1

        def misalignment(x, T=T):
            pose = forward_kinematics(chain, x)
            turn = T[:3, :3] @ pose[:3, :3].T
            axial = [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
            return -np.trace(turn), -np.array(axial) @ jacobian(chain, x)[:3]

        place = {
            "type": "eq",
            "fun": lambda x, T=T: forward_kinematics(chain, x)[:3, 3] - T[:3, 3],
            "jac": lambda x: jacobian(chain, x)[3:],
        }
        for _ in range(4):
            start = rng.uniform(-np.pi, np.pi, chain.n)
            found = minimize(
                misalignment,
                start,
                jac=True,
                method="SLSQP",
                constraints=place,
                options={"maxiter": 200},
            )
            if np.abs(place["fun"](found.x)).max() < 1e-8:
                other = math.acos(min(1.0, 0.5 * (-found.fun - 1.0)))
                assert gap.orientation_error < other + 1e-3


def test_a_search_or_two_and_the_same_every_time(counted_search):
    chain = load_robot("panda")
    rng = np.random.default_rng(4)
    for _ in range(20):
        T = pose_at(rng.normal(size=3), rng)
        first = reach_gap(chain, T)
        assert counted_search.starts == REACH_STARTS
        assert counted_search.attempts in (0, REACH_ATTEMPTS + 1)
        np.testing.assert_array_equal(first, reach_gap(chain, T))
        counted_search.forget()
