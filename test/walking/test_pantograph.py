"""Pantograph legs: against their closed loops, finite differences, and a solver of the loops."""

import numpy as np
import pytest
from scipy.optimize import fsolve

from robomech_ros.errors import RobomechError
from robomech_ros.walking import LeggedRobot, PantographLeg, Walker

HIP = np.array([0.2, 0.1, -0.05])
LEG = PantographLeg(thigh=0.41, shank=0.37, ratio=4.5, hip=HIP)


def random_drives(rng):
    return np.array([rng.uniform(-0.6, 0.6), rng.uniform(-0.05, 0.05), rng.uniform(0.06, 0.13)])


@pytest.mark.parametrize("knee", ["forward", "back"])
def test_links_keep_their_lengths_and_loops_close(knee):
    rng = np.random.default_rng(1)
    for _ in range(50):
        p = LEG.points(random_drives(rng), knee)
        lengths = {
            ("A", "D"): LEG.thigh,
            ("D", "F"): LEG.shank,
            ("A", "E"): LEG.thigh / LEG.ratio,
            ("E", "B"): LEG.shank / LEG.ratio,
            ("B", "G"): LEG.thigh * (1.0 - 1.0 / LEG.ratio),
            ("D", "G"): LEG.shank / LEG.ratio,
            ("E", "D"): LEG.thigh * (1.0 - 1.0 / LEG.ratio),
        }
        for (one, other), length in lengths.items():
            assert np.linalg.norm(p[one] - p[other]) == pytest.approx(length, abs=1e-12)
        # E is on the thigh, G on the shank, all in one plane with the axis.
        assert np.abs(np.cross(p["E"] - p["A"], p["D"] - p["A"])).max() < 1e-12
        assert np.abs(np.cross(p["G"] - p["D"], p["F"] - p["D"])).max() < 1e-12
    assert LEG.points([0.0, 0.0, 0.1], "forward")["D"][0] > HIP[0]
    assert LEG.points([0.0, 0.0, 0.1], "back")["D"][0] < HIP[0]


def test_the_foot_is_where_the_angles_of_the_links_put_it():
    """The oracle knows link lengths and angles only: the loop A-E-B is solved numerically."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        turn, h, v = drives = random_drives(rng)

        def loop(angles, h=h, v=v):
            a, b = angles
            thigh, shank = LEG.thigh / LEG.ratio, LEG.shank / LEG.ratio
            x = thigh * np.sin(a) + shank * np.sin(b) - h
            z = v - thigh * np.cos(a) - shank * np.cos(b)
            return [x, z]

        a, b = fsolve(loop, [0.8, -0.8], xtol=1e-12)
        x = LEG.thigh * np.sin(a) + LEG.shank * np.sin(b)
        z = v - LEG.thigh * np.cos(a) - LEG.shank * np.cos(b)
        foot = HIP + [x, -z * np.sin(turn), z * np.cos(turn)]
        assert LEG.foot(drives) == pytest.approx(foot, abs=1e-9)


def test_each_slide_moves_the_foot_in_one_direction():
    here = LEG.foot([0.0, 0.01, 0.1])
    assert LEG.foot([0.0, 0.02, 0.1]) - here == pytest.approx([0.045, 0.0, 0.0], abs=1e-15)
    assert LEG.foot([0.0, 0.01, 0.11]) - here == pytest.approx([0.0, 0.0, -0.035], abs=1e-15)


def test_the_jacobian_is_that_of_finite_differences_and_drives_come_back():
    rng, step = np.random.default_rng(3), 1e-6
    for _ in range(50):
        q = random_drives(rng)
        moved = [LEG.foot(q + step * one) - LEG.foot(q - step * one) for one in np.eye(3)]
        assert np.abs(LEG.jacobian(q) - np.transpose(moved) / (2 * step)).max() < 1e-8
        assert LEG.drives(LEG.foot(q)) == pytest.approx(q, abs=1e-12)
        rates = rng.normal(size=3)
        force = rng.normal(size=3)
        power = (LEG.jacobian(q).T @ force) @ rates
        assert power == pytest.approx(force @ (LEG.jacobian(q) @ rates), abs=1e-12)


def test_a_machine_walks_on_pantographs():
    """Feet, postures and forces of its legs are those of the pantographs; it walks at once."""
    low, high, fast = [-0.4, -0.06, 0.09], [0.4, 0.06, 0.14], [2.0, 0.3, 0.3]
    places = [(x, y) for y in (0.3, -0.3) for x in (0.6, 0.0, -0.6)]
    legs = [PantographLeg(0.41, 0.37, 4.5, [x, y, 0.0]) for x, y in places]
    chains = {
        f"leg{i}": leg.chain(f"leg{i}", low, high, velocity=fast) for i, leg in enumerate(legs)
    }
    robot = LeggedRobot(chains, home=np.tile(legs[0].gains * [0.0, 0.0, 0.12], 6))
    rng = np.random.default_rng(5)
    drives = rng.uniform(low, high, (6, 3))
    joints = drives * legs[0].gains
    expected = [leg.foot(one) for leg, one in zip(legs, drives, strict=True)]
    np.testing.assert_allclose(robot.feet(joints.ravel()), expected, atol=1e-14)
    for i, leg in enumerate(legs):
        jacobian = leg.jacobian(drives[i])
        found = robot.foot_jacobians(joints.ravel())[i] * leg.gains
        np.testing.assert_allclose(found, jacobian, atol=1e-14)
        np.testing.assert_allclose(robot.postures(f"leg{i}", expected[i]).q[0], joints[i])
    np.testing.assert_allclose(robot.velocity[:3], fast * legs[0].gains)
    walker = Walker(robot)
    for _ in range(400):
        walker.command([0.0, 0.05, 0.0])
        update = walker.update()
        assert update.margin > walker.bound
    assert update.base[0] > 0.05 and update.walking


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: PantographLeg(0.0, 1.0, 4.0), "thigh"),
        (lambda: PantographLeg(1.0, np.inf, 4.0), "shank"),
        (lambda: PantographLeg(1.0, 1.0, 1.0), "ratio"),
        (lambda: PantographLeg(1.0, 1.0, "4"), "ratio"),
        (lambda: PantographLeg(1.0, 1.0, 4.0, [0.0, 1.0]), "hip"),
        (lambda: LEG.foot([0.0, 0.0]), "drives"),
        (lambda: LEG.foot([0.0, np.nan, 0.1]), "drives"),
        (lambda: LEG.foot([0.0, 0.0, 0.5]), "apart"),
        (lambda: LEG.foot([0.0, 0.0, 0.0]), "apart"),
        (lambda: LEG.jacobian([0.0, 0.0, 0.5]), "apart"),
        (lambda: LEG.points([0.0, 0.0, 0.1], "left"), "one of forward, back"),
        (lambda: LEG.drives([0.5, 0.1, -0.05]), "not on the axis"),
        (lambda: LEG.drives([0.2, 0.1, -3.0]), "apart"),
        (lambda: LEG.drives([[0.0] * 3]), "foot"),
        (lambda: LEG.chain("leg", [0.0, 0.0, 0.1], [0.1, 0.0, 0.12]), "lower"),
        (lambda: LEG.chain("leg", [0.0, 0.0, 0.1], [0.1, 0.1, 0.5]), "apart"),
        (lambda: LEG.chain("leg", [0.0, 0.0], [0.1, 0.1, 0.12]), "lower"),
        # The corners are within reach, the middle is not.
        (lambda: LEG.chain("leg", [0.0, -0.02, -0.1], [0.1, 0.02, 0.1]), "drives is [0.0, 0.0, "),
    ],
)
def test_wrong_requests_name_what_is_wrong(call, text):
    with pytest.raises(RobomechError) as caught:
        call()
    assert text in str(caught.value)
