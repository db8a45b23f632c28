"""Legs, stance, planted feet as a parallel robot, stability and gaits."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import RobomechError, RobotDescriptionError, UnknownRobotError
from robomech_ros.kinematics import Status
from robomech_ros.robots import load_description
from robomech_ros.walking import (
    GAITS,
    LeggedRobot,
    list_legged,
    load_legged,
    stability_margin,
    support_polygon,
)

ROBOTS = ("phantomx", "go1")
SQUARE = [[0.2, 0.15], [0.2, -0.15], [-0.2, -0.15], [-0.2, 0.15]]
TRIPOD = [[0.25, 0.2], [0.0, -0.25], [-0.25, 0.2]]


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request):
    return load_legged(request.param)


def near_home(robot, rng, size=0.1):
    return np.clip(robot.home + rng.uniform(-size, size, robot.n), robot.lower, robot.upper)


def moved(twist, time):
    return pinocchio.exp6(pinocchio.Motion(twist[3:] * time, twist[:3] * time)).homogeneous


def test_the_margin_of_the_facts():
    """Distances to the polygon: four feet 0.15, three of them 0, a tripod 0.121411."""
    assert stability_margin([0.0, 0.0], SQUARE) == pytest.approx(0.15, abs=1e-15)
    assert stability_margin([0.0, 0.0], SQUARE[:3]) == pytest.approx(0.0, abs=1e-15)
    assert stability_margin([0.0, 0.0], TRIPOD) == pytest.approx(0.121411, abs=5e-7)


def test_the_margin_is_the_least_distance_along_any_direction():
    """The oracle: the hull lies on one side of a line in each of many directions."""
    rng = np.random.default_rng(1)
    angles = np.linspace(0.0, 2.0 * np.pi, 20001)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for _ in range(100):
        feet = rng.normal(size=(rng.integers(1, 7), 2))
        point = rng.normal(size=2)
        expected = ((feet @ directions.T).max(axis=0) - directions @ point).min()
        assert stability_margin(point, feet) == pytest.approx(expected, abs=2e-3)
    batch = rng.normal(size=(3, 2, 2))
    assert stability_margin(batch, SQUARE).shape == (3, 2)


def test_the_polygon_leaves_out_what_is_inside():
    feet = [*SQUARE, [0.0, 0.0], [0.2, 0.0]]
    corners = support_polygon(feet)
    assert sorted(map(tuple, corners)) == sorted(map(tuple, SQUARE))
    x, y = corners.T
    assert 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) == pytest.approx(0.12)
    assert len(support_polygon(SQUARE[:1])) == 1 and len(support_polygon(SQUARE[:2])) == 2


@pytest.mark.parametrize("name", GAITS)
def test_duty_factors_are_exact(name):
    gait = GAITS[name]
    for legs, offsets in gait.offsets.items():
        stances = np.array(gait.stances(legs))
        assert stances.sum(axis=1).min() >= (3 if gait.static else 2)
        # As long as a part of the cycle is a whole number of steps, counting is exact.
        steps = 840
        phases = [Fraction(k, steps) for k in range(steps)]
        for offset in offsets:
            standing = sum((phase + offset) % 1 < gait.duty for phase in phases)
            assert Fraction(standing, steps) == gait.duty
    with pytest.raises(RobomechError, match="number of legs for the gait"):
        gait.phases(5)
    assert GAITS["trot"].phases(np.int64(4)) == GAITS["trot"].phases(4)


@pytest.mark.parametrize(
    ("name", "order"),
    [
        # From rear to front on one side, then on the other; legs are counted from the front left.
        ("wave", (2, 1, 0, 5, 4, 3)),
        ("ripple", (2, 4, 0, 5, 1, 3)),
        ("crawl", (2, 0, 3, 1)),
    ],
)
def test_legs_lift_off_in_the_order_of_the_gait(name, order):
    gait = GAITS[name]
    lifts = [(gait.duty - offset) % 1 for offset in gait.phases(len(order))]
    assert tuple(np.argsort(lifts)) == order


def test_robots_are_listed_and_their_dimensions_are_those_published():
    assert set(ROBOTS) <= set(list_legged())
    go1, phantomx = load_legged("go1"), load_legged("phantomx")
    foot = go1.feet(go1.home)[0]
    assert foot[:2] == pytest.approx([0.1881, 0.04675 + 0.08])
    assert foot[2] == pytest.approx(-2 * 0.213 * np.cos(0.8))
    reach = np.linalg.norm(phantomx.feet(np.zeros(18))[1] - [0.0, 0.1, 0.0])
    assert reach == pytest.approx(0.052 + 0.065 + 0.133)
    with pytest.raises(UnknownRobotError, match="phantomx"):
        load_legged("phantomy")


def test_all_branches_of_a_leg(robot):
    rng = np.random.default_rng(2)
    rows = near_home(robot, rng).reshape(-1, 3)
    for leg, row, foot in zip(robot.leg_names, rows, robot.feet(rows.ravel()), strict=True):
        found = robot.postures(leg, foot, seed=row, respect_limits=False)
        assert found.complete and len(found.q) >= 2
        assert found.q[0] == pytest.approx(row, abs=1e-9)
    far = robot.postures(robot.leg_names[0], [3.0, 0.0, 0.0])
    assert far.status == Status.OUT_OF_REACH


def test_stance_feet_stand_still_and_the_twist_comes_back(robot):
    """Finite differences: the trunk moves as told, feet stay where they are on the ground."""
    rng = np.random.default_rng(3)
    step = 1e-5
    for _ in range(10):
        q, twist = near_home(robot, rng), rng.normal(size=6)
        rates = robot.stance_rates(q, twist)
        feet = [
            robot.feet(q + sign * step * rates) @ T[:3, :3].T + T[:3, 3]
            for sign in (1.0, -1.0)
            for T in [moved(twist, sign * step)]
        ]
        assert np.abs(feet[0] - feet[1]).max() / (2 * step) < 1e-7
        found, slip = robot.body_twist(q, rates)
        assert found == pytest.approx(twist, abs=1e-10) and slip < 1e-10
        wrong = rates + np.eye(robot.n)[0]
        assert robot.body_twist(q, wrong)[1] > 1e-3


def test_planted_feet_are_a_parallel_robot(robot):
    """Rates and closed loops of the mechanism are those of legs solved one by one."""
    rng = np.random.default_rng(4)
    q = near_home(robot, rng, 0.05)
    stance = robot.leg_names[::2] if len(robot.legs) == 6 else robot.leg_names[:3]
    mechanism = robot.planted(q, stance)
    assert mechanism.dof == 6
    at = np.zeros(len(mechanism.joint_names))
    assert np.abs(mechanism.pose(at) - np.eye(4)).max() < 1e-12
    twist = 0.1 * rng.normal(size=6)
    rates = robot.stance_rates(q, twist, stance)
    index = [robot.joint_names.index(name) for name in mechanism.actuated]
    found, reached = mechanism.rates(at, rates[index])
    assert reached == pytest.approx(twist, abs=1e-10)
    named = dict(zip(mechanism.joint_names, found, strict=True))
    ours = dict(zip(robot.joint_names, rates, strict=True))
    assert all(
        named[name] == pytest.approx(ours[name], abs=1e-10) for name in named if name in ours
    )


def test_any_urdf_can_walk(tmp_path):
    """The same legs from a URDF, by itself and named by a document."""
    joints = []
    for leg, (x, y) in {"A": (1, 1), "B": (-1, 1), "C": (0, -1)}.items():
        parent, place = "trunk", f"{0.2 * x} {0.2 * y} 0"
        for k, axis in enumerate(("0 0 1", "1 0 0", "1 0 0")):
            child = f"{leg}{k}"
            joints.append(
                f'<link name="{child}"/><joint name="{leg}_{k}" type="revolute"><parent '
                f'link="{parent}"/><child link="{child}"/><origin xyz="{place}"/>'
                f'<axis xyz="{axis}"/><limit lower="-2" upper="2" velocity="5" effort="1"/></joint>'
            )
            parent, place = child, "0 0 -0.1" if k else "0 0.05 0"
        joints.append(
            f'<link name="{leg}_foot"/><joint name="{leg}_end" type="fixed"><parent '
            f'link="{parent}"/><child link="{leg}_foot"/><origin xyz="0 0 -0.1"/></joint>'
        )
    text = f'<robot name="three"><link name="trunk"/>{"".join(joints)}</robot>'
    home = [0.0, 0.5, -1.0] * 3
    robot = LeggedRobot.from_description(
        load_description(text), {leg: f"{leg}_foot" for leg in "ABC"}, home=home
    )
    (tmp_path / "three.urdf").write_text(text)
    legs = "".join(f"  - {{name: {leg}, foot: {leg}_foot, home: {home[:3]}}}\n" for leg in "ABC")
    path = tmp_path / "three_walking.yaml"
    path.write_text(f"kind: walking\nname: three\nsource: ours\nurdf: three.urdf\nlegs:\n{legs}")
    other = load_legged(path)
    assert np.array_equal(other.feet(home), robot.feet(home))
    assert other.joint_names == robot.joint_names


QUADRUPED = (Path(__file__).parents[1] / "data" / "quadruped_with_head.urdf").read_text("utf-8")
QUADRUPED_FEET = {leg: f"{leg}_foot" for leg in ("FL", "FR", "RL", "RR")}


def test_the_masses_of_a_urdf_give_the_mass_centre_and_the_margin(tmp_path):
    robot = LeggedRobot.from_description(load_description(QUADRUPED), QUADRUPED_FEET)
    np.testing.assert_allclose(robot.mass_centre, [0.105, 0.0, 0.03], atol=1e-12)
    feet = robot.feet(np.zeros(12))[1:, :2]
    assert stability_margin(robot.mass_centre[:2], feet) == pytest.approx(-0.047, abs=5e-4)
    (tmp_path / "quadruped.urdf").write_text(QUADRUPED)
    legs = "".join(
        f"  - {{name: {leg}, foot: {foot}, home: [0, 0.7, -1.5]}}\n"
        for leg, foot in QUADRUPED_FEET.items()
    )
    path = tmp_path / "quadruped_walking.yaml"
    text = f"kind: walking\nname: q\nsource: ours\nurdf: quadruped.urdf\nlegs:\n{legs}"
    path.write_text(text)
    np.testing.assert_allclose(load_legged(path).mass_centre, [0.105, 0.0, 0.03], atol=1e-12)
    path.write_text(f"{text}mass_centre: [0.1, 0, 0]\n")
    np.testing.assert_array_equal(load_legged(path).mass_centre, [0.1, 0.0, 0.0])


def test_the_mass_centre_counts_the_legs_at_home_as_pinocchio_does():
    calf = (
        '<link name="FL_c"><inertial><origin xyz="0.01 0.02 -0.1"/><mass value="2"/>'
        '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>'
    )
    text = QUADRUPED.replace('<link name="FL_c"/>', calf)
    robot = LeggedRobot.from_description(load_description(text), QUADRUPED_FEET)
    model = pinocchio.buildModelFromXML(text, pinocchio.JointModelFreeFlyer())
    q = pinocchio.neutral(model)
    for name, position in zip(robot.joint_names, robot.home, strict=True):
        q[model.joints[model.getJointId(name)].idx_q] = position
    centre = pinocchio.centerOfMass(model, model.createData(), q)
    np.testing.assert_allclose(robot.mass_centre, centre, atol=1e-12)


def test_wrong_requests_name_what_is_wrong(robot):
    q = robot.home
    legs = dict(zip(robot.leg_names, robot.legs, strict=True))
    first = robot.leg_names[0]
    cases = [
        (lambda: LeggedRobot(dict(list(legs.items())[:2])), "number of legs is 2"),
        (lambda: LeggedRobot({str(k): robot.legs[0] for k in range(17)}), "at most 16"),
        (lambda: LeggedRobot({**legs, first: 3}), f"leg '{first}' is 3"),
        (lambda: LeggedRobot(legs, home=[9.0] * robot.n), robot.joint_names[0]),
        (lambda: LeggedRobot(legs, mass_centre=[np.nan, 0, 0]), "mass_centre"),
        (lambda: robot.postures("leg", [0, 0, 0]), f"one of {first}"),
        (lambda: robot.stance_rates(q, [np.nan] * 6), "twist"),
        (lambda: robot.body_twist(q, q, robot.leg_names[:2]), "at least 3 legs"),
        (lambda: robot.planted(q, robot.leg_names[:2]), "at least 3 legs"),
        (lambda: stability_margin([0, 0], np.empty((0, 2))), "number of feet"),
        (lambda: stability_margin([0, np.inf], SQUARE), "com_xy"),
        (lambda: support_polygon([0.0, 1.0]), "feet_xy"),
    ]
    for call, text in cases:
        with pytest.raises(RobomechError) as caught:
            call()
        assert text in str(caught.value)


@pytest.mark.parametrize(
    ("document", "text"),
    [
        ("kind: parallel\nname: a\nsource: b\nlegs: []\n", "expected walking"),
        ("kind: walking\nname: a\nsource: b\nlegs: []\n", "expected a list of legs"),
        ("kind: walking\nname: a\nsource: b\nlegs: [{}]\n", "leg 1"),
    ],
)
def test_documents_that_cannot_be_used(document, text):
    with pytest.raises(RobotDescriptionError) as caught:
        load_legged(document)
    assert text in str(caught.value)


@pytest.mark.parametrize("least", ["x", None, [1, 2], 2.5])
def test_how_many_legs_have_to_stand_is_a_whole_number(least):
    with pytest.raises(RobomechError, match="least"):
        load_legged("phantomx").standing([], least)
