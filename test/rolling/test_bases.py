"""Wheels and bases: the book's robots, figures of ros2_control, mobility, what cannot roll."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    InconsistentDataError,
    LimitExceededError,
    UnderdeterminedError,
)
from robomech_ros.rolling import (
    RollingBase,
    Wheel,
    ackermann,
    differential_drive,
    isotropy,
    list_rolling,
    load_rolling,
    mecanum,
    omnidirectional,
    swerve,
    tricycle,
)

GOLDEN = json.loads(
    (Path(__file__).parents[1] / "data" / "golden" / "rolling.json").read_text(encoding="utf-8")
)
CORNERS = ((0.2, 0.2), (0.2, -0.2), (-0.2, 0.2), (-0.2, -0.2))
TYPES = {
    "ackermann": "(1,1)",
    "differential": "(2,0)",
    "mecanum": "(3,0)",
    "omni": "(3,0)",
    "swerve": "(1,2)",
    "tricycle": "(1,1)",
}


def caster(position=(-0.3, 0.0), **more):
    return Wheel(kind="caster", position=position, radius=0.05, trail=0.1, **more)


def test_mecanum_of_the_book():
    case = GOLDEN["mecanum4"]
    wheels = [
        Wheel(kind="omni", position=place, radius=case["radius"], roller=math.radians(angle))
        for place, angle in zip(
            case["wheel_centres"], case["roller_axis_deg_from_rolling_dir"], strict=True
        )
    ]
    base = RollingBase(wheels)
    K = np.array(case["K_rows_omega_vx_vy"])
    assert np.abs(base.rate_rows() - K).max() < GOLDEN["tolerance"] * 10
    twist = np.array([0.3, -0.2, 0.7])
    assert np.abs(base.wheel_rates(twist) - K @ twist).max() < 1e-12


def test_three_wheels_of_the_book_are_isotropic():
    case = GOLDEN["omni3"]
    wheels = [
        Wheel(
            kind="omni",
            position=case["distance"] * np.array([math.cos(at), math.sin(at)]),
            radius=case["radius"],
            heading=math.radians(way),
        )
        for at, way in zip(np.radians(case["wheel_pos_deg"]), case["rolling_dir_deg"], strict=True)
    ]
    base = RollingBase(wheels)
    assert np.abs(base.rate_rows() - case["K_rows_omega_vx_vy"]).max() < 1e-11
    found = isotropy(base)
    assert found.isotropic
    assert found.length == pytest.approx(math.sqrt(2.0) * case["distance"], abs=1e-12)
    A = found.matrix.T @ found.matrix
    assert np.abs(A - np.diag([75.0, 600.0, 600.0])).max() < 1e-9


def test_characteristic_length_is_where_the_condition_number_is_least():
    angles, places = (0.1, 0.7, -0.4, -0.9), ((0.4, 0.2), (0.3, -0.3), (-0.2, 0.3), (-0.5, -0.1))
    base = RollingBase([
        Wheel(kind="omni", position=place, radius=0.1, heading=angle, roller=angle / 2.0)
        for place, angle in zip(places, angles, strict=True)
    ])  # fmt: skip
    found = isotropy(base)

    def condition(length):
        A = found.matrix / np.array([length, 1.0, 1.0])
        A = A.T @ A
        return math.sqrt(np.trace(A) * np.trace(np.linalg.inv(A))) / 3.0

    assert found.condition_number == pytest.approx(condition(found.length), rel=1e-12)
    assert condition(found.length) <= min(condition(found.length * f) for f in (0.99, 1.01))
    assert not found.isotropic


def test_two_driven_wheels_and_a_caster_of_the_book():
    case = GOLDEN["differential_with_caster"]
    base = differential_drive(
        case["r"],
        case["track"],
        casters=[
            Wheel(
                kind="caster",
                position=(case["pivot_offset_forward"], 0.0),
                radius=case["r_caster"],
                trail=case["bracket"],
            )
        ],
    )
    twist, slip = base.body_twist([case["thdL"], case["thdR"]])
    assert np.abs(twist - [case["omega"], case["v"], 0.0]).max() < 1e-12
    assert slip < 1e-12
    assert base.caster_rates(twist, [case["psi"]])[0] == pytest.approx(case["psidot"], abs=1e-12)
    rates = base.rolling_rates(twist, brackets=[case["psi"]])
    assert rates == pytest.approx([case["thdL"], case["thdR"], case["thd3"]], abs=1e-12)


def test_black_box_1_rates_of_the_controllers_of_ros2_control():
    assert differential_drive(0.1, 0.4).wheel_rates([1.0, 0.5, 0.0]) == pytest.approx(
        [3.0, 7.0], abs=1e-9
    )
    assert mecanum(0.1, 0.6, 0.4).wheel_rates([0.2, 1.0, 0.5]) == pytest.approx(
        [4.0, 16.0, 6.0, 14.0], abs=1e-9
    )
    rates = omnidirectional(3, 0.1, 0.5).wheel_rates([0.1, 0.1, 0.2])
    assert rates == pytest.approx([-2.5, 1.3660254037844, -0.3660254037844], abs=1e-9)
    car = ackermann(0.15, 1.2, 0.8)
    assert car.wheel_rates([0.5, 1.0, 0.0]) == pytest.approx([8.0, 16.0 / 3.0], abs=1e-9)
    angles = car.steering_angles([0.5, 1.0, 0.0])
    assert angles == pytest.approx([math.atan(0.5), math.atan(0.75)], abs=1e-9)


def twists_of(base, count=50):
    """Twists that a base can have, and angles at which its wheels roll then."""
    rng = np.random.default_rng(5)
    twists = base.feasible(rng.normal(size=(count, 3)))
    return twists, base.steering_angles(twists) if base.steered else None


@pytest.mark.parametrize("name", list_rolling())
def test_rates_lead_back_to_the_twist_without_slip(name):
    base = load_rolling(name)
    assert base.mobility.type == TYPES[name]
    assert base.mobility.maneuverability == (2 if TYPES[name] in ("(2,0)", "(1,1)") else 3)
    twists, angles = twists_of(base)
    rates = base.wheel_rates(twists)
    assert rates.shape == (50, len(base.driven))
    found, slip = base.body_twist(rates, angles)
    assert np.abs(found - twists).max() < 1e-12
    assert slip.max() < 1e-12
    for i in (0, 7):
        alone = None if angles is None else angles[i]
        assert np.abs(base.wheel_rates(twists[i]) - rates[i]).max() < 1e-12
        assert np.abs(base.body_twist(rates[i], alone)[0] - twists[i]).max() < 1e-12


@pytest.mark.parametrize("name", list_rolling())
def test_no_wheel_slips(name):
    """The point of a wheel that touches the ground only moves as its rollers do."""
    base = load_rolling(name)
    twists, angles = twists_of(base)
    rates = base.rolling_rates(twists)
    turned = iter(range(99))
    for i, wheel in enumerate(base.wheels):
        if wheel.kind == "caster":
            continue
        angle = np.full(50, wheel.heading)
        if wheel.kind == "steered":
            angle = angle + angles[:, next(turned)]
        velocity = twists[:, 1:] + twists[:, :1] * np.array([-wheel.position[1], wheel.position[0]])
        rolled = (
            rates[:, i, None] * wheel.radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        )
        slip = velocity - rolled
        if wheel.kind == "omni":  # a roller lets its point slip at right angles to its axis
            axis = angle + wheel.roller
            slip = (slip * np.stack([np.cos(axis), np.sin(axis)], axis=-1)).sum(axis=-1)
        assert np.abs(slip).max() < 1e-12, wheel.name


def test_slip_is_what_the_wheels_contradict_each_other_by():
    base = mecanum(0.1, 0.6, 0.4)
    rates = base.wheel_rates([0.2, 1.0, 0.5]) + [0.3, 0.0, 0.0, 0.0]
    twist, slip = base.body_twist(rates)
    # A quarter of the vector (1, -1, ...) that no twist can give, by the radius.
    assert slip == pytest.approx(0.1 * 0.3 / 2.0, rel=1e-9)
    K = base.rate_rows()
    assert np.abs(twist - np.linalg.lstsq(K, rates, rcond=None)[0]).max() < 1e-12


def test_steered_wheels_turn_the_short_way_and_stay_where_they_do_not_move():
    base = swerve(0.05, [[0.2, 0.2], [-0.2, -0.2]], max_steering_rate=5.0)
    assert base.steering_angles([0.0, -1.0, 0.0]) == pytest.approx([0.0, 0.0], abs=1e-15)
    assert base.wheel_rates([0.0, -1.0, 0.0]) == pytest.approx([-20.0, -20.0])
    near = [3.0, 2.0]
    assert base.steering_angles([0.0, 0.0, 0.0], near) == pytest.approx(near)
    # It turns about the first wheel.
    angles = base.steering_angles([1.0, 0.2, -0.2], near)
    assert angles[0] == 3.0
    assert angles[1] != 2.0


def test_curvature_is_what_the_inner_wheel_allows():
    car = ackermann(0.15, 1.2, 0.8, steering_limit=0.5)
    sharpest = 1.0 / (1.2 / math.tan(0.5) + 0.4)
    assert car.curvatures == pytest.approx((-sharpest, sharpest), rel=1e-12)
    # The speed is kept; on the spot a car does not turn.
    assert car.feasible([-9.0, 2.0, 0.3]) == pytest.approx([-2.0 * sharpest, 2.0, 0.0])
    assert car.feasible([-9.0, -2.0, 0.0]) == pytest.approx([-2.0 * sharpest, -2.0, 0.0])
    assert car.feasible([1.0, 0.0, 0.0]) == pytest.approx([0.0, 0.0, 0.0])
    assert car.steering_angles(car.feasible([9.0, 2.0, 0.0]))[1] == pytest.approx(0.5)
    assert tricycle(0.1, 1.0, 0.6).curvatures == (-math.inf, math.inf)


def test_the_origin_may_be_anywhere():
    """A fixed axle in front of the origin takes a turn with a sideways velocity."""
    wheels = [Wheel(kind="fixed", position=(0.3, y), radius=0.1) for y in (0.2, -0.2)]
    base = RollingBase(wheels)
    twist = base.feasible([1.0, 0.5, 0.0])
    assert twist == pytest.approx([1.0, 0.5, -0.3])
    assert base.wheel_rates(twist) == pytest.approx([3.0, 7.0])


@pytest.mark.parametrize(
    ("wheels", "error", "text"),
    [
        (  # skid steering: four fixed wheels
            [Wheel(kind="fixed", position=(x, y), radius=0.1) for x, y in CORNERS],
            InconsistentDataError,
            "one common axle",
        ),
        (
            [Wheel(kind="omni", position=(x, 0.1 * x), radius=0.1) for x in (0.1, 0.2, 0.3)],
            UnderdeterminedError,
            "free now are twists",
        ),
        (  # rollers as they must not be: all alike
            [Wheel(kind="omni", position=(x, y), radius=0.1, roller=0.7)
             for x in (0.2, -0.2) for y in (0.2, -0.2)],
            UnderdeterminedError,
            "free now are twists",
        ),
        (
            [Wheel(kind="omni", position=(0.1, 0.1), radius=0.1)] * 2,
            BadValueError,
            "names that differ|different places",
        ),
        ([caster()], BadValueError, "a driven wheel"),
        ([], ValueError, "one wheel or more"),
        (
            [Wheel(kind="steered", position=(x, 0.0), radius=0.1, steering_limits=(-1.0, 1.0))
             for x in (0.2, -0.2)],
            BadValueError,
            "at least pi apart",
        ),
    ],
)  # fmt: skip
def test_wheels_that_contradict_each_other_or_do_not_suffice(wheels, error, text):
    with pytest.raises(error, match=text):
        RollingBase(wheels)


def test_free_twists_are_named():
    wheels = [Wheel(kind="omni", position=(0.0, y), radius=0.1) for y in (0.1, 0.2, 0.3)]
    with pytest.raises(UnderdeterminedError) as caught:
        RollingBase(wheels)
    assert np.abs(caught.value.free) == pytest.approx(np.array([[0.0, 0.0, 1.0]]))


def test_black_box_15_a_component_that_the_wheels_cannot_give():
    base = differential_drive(0.1, 0.4)
    with pytest.raises(BadValueError, match=r"twist is .*such as \[1\.0, 0\.5, 0\.0\]"):
        base.wheel_rates([1.0, 0.5, 0.2])
    assert base.feasible([1.0, 0.5, 0.2]).tolist() == [1.0, 0.5, 0.0]
    with pytest.raises(BadValueError, match="twist is"):
        ackermann(0.15, 1.2, 0.8).wheel_rates([3.0, 1.0, 0.0])


def test_a_wheel_that_cannot_be_steered_so_far_is_named():
    car = ackermann(0.15, 1.2, 0.8, steering_limit=0.4)
    with pytest.raises(LimitExceededError, match="'front_right' is .* its limit 0.4 rad"):
        car.steering_angles([1.0, 1.5, 0.0])


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"radius": -0.1}, "radius is -0.1"),
        ({"radius": math.nan}, "radius is nan"),
        ({"position": (1.0, math.inf)}, r"position\[1\] is inf"),
        ({"kind": "track"}, "kind is 'track', expected one of fixed, steered"),
        ({"kind": "omni", "roller": math.pi / 2}, "could not drive"),
        ({"roller": 0.5}, "none for a wheel of kind 'fixed'"),
        ({"kind": "caster"}, "trail is 0.0"),
        ({"kind": "caster", "trail": 0.1, "driven": True}, "none for a wheel of kind 'caster'"),
        ({"kind": "steered", "steering_limits": (0.5, 0.1)}, "steering_limits is"),
        ({"max_steering_rate": 2.0}, "none for a wheel of kind 'fixed'"),
        ({"max_rate": 0.0}, "max_rate is 0.0"),
    ],
)
def test_wheels_that_are_none(change, text):
    good = {"kind": "fixed", "position": (0.0, 0.2), "radius": 0.1}
    with pytest.raises(ValueError, match=text):
        Wheel(**(good | change))
