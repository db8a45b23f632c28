"""Crossing curves: what is drawn, and the problems behind it."""

import re

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.robots import load_robot
from robomech_ros.rvs.model.curves.curve_drawing import BOTTOM, LEFT, SIDE, TOP, Mark, draw_curves
from robomech_ros.rvs.model.curves.curve_problems import (
    Axis,
    equations_problem,
    minor_names,
    posture_problem,
    what_is_missing,
)

TURN = (Axis("q4", "rad", -np.pi, np.pi), Axis("<q5>", "rad", -np.pi, np.pi))


def labels(axes):
    return re.findall(r"<text [^>]*>([^<]*)</text>", draw_curves(axes, ((), ())))


def test_ticks():
    turn = labels(TURN)
    assert turn[:5] == ["\N{MINUS SIGN}π", "\N{MINUS SIGN}π/2", "0", "π/2", "π"]
    assert "&lt;q5&gt; (rad)" in turn
    plain = labels((Axis("x", "", -3.0, 3.0), Axis("y", "", 0.0, 0.07)))
    assert plain[:7] == ["\N{MINUS SIGN}3", *[f"\N{MINUS SIGN}{k}" for k in (2, 1)], *"0123"]
    assert [text for text in plain if text.startswith("0.0")] == ["0.02", "0.04", "0.06"]


def test_curves_marks_and_steps():
    line = np.linspace([-np.pi, -np.pi], [np.pi, np.pi], 5000)
    path = np.array([[0.5, 0.5], [0.1, 0.1], [0.0, 0.0]])
    marks = [Mark("root", np.zeros(2), "3", "rgb(1, 2, 3)"), Mark("spurious", np.ones(2))]
    text = draw_curves(TURN, ((line,), ()), marks, path, "f('a&b')")
    first = re.search(r'data-curve="1" d="M([\d.]+) ([\d.]+)L.*?([\d.]+) ([\d.]+)"', text)
    assert [float(value) for value in first.groups()] == [LEFT, BOTTOM, LEFT + SIDE, BOTTOM - TOP]
    # Thousands of points a curve would be slow to draw.
    assert len(text) < 20_000
    assert 'data-steps="2"' in text
    assert f'cx="{LEFT + SIDE / 2:.2f}" cy="{BOTTOM - TOP / 2:.2f}" r="6.5"' in text
    assert text.count("data-mark") == 2
    assert "f(&#x27;a&amp;b&#x27;)" in text


@pytest.mark.parametrize("name", ["ur5e", "puma560", "general6r"])
@pytest.mark.parametrize("pair", [(0, 19), (3, 11)])
def test_postures_are_found_by_pointing(name, pair):
    chain = load_robot(name)
    T = forward_kinematics(chain, np.random.default_rng(3).uniform(-2.0, 2.0, 6))
    problem = posture_problem(chain, T, pair)
    solutions = inverse_kinematics(chain, T, respect_limits=False).q
    for q in solutions:
        found = problem.refine((q[3:5] + 1e-4 + np.pi) % (2.0 * np.pi) - np.pi)
        assert found.is_root
        assert np.abs(forward_kinematics(chain, found.q) - T).max() < 1e-12
        assert np.abs((found.q - q + np.pi) % (2.0 * np.pi) - np.pi).max() < 1e-7
    everything = problem.all()
    assert sum(found.is_root for found in everything) == len(solutions)
    assert all(found.q is None for found in everything if not found.is_root)
    assert problem.others == len(minor_names()) - 2


def test_equations_that_are_left_over_tell_roots():
    axes = (Axis("x", "", -3.0, 3.0), Axis("y", "", -3.0, 3.0))
    problem = equations_problem(
        lambda x, y: [x - 1.0, x + y - 3.0, y**2 - 1.0, y - 2.0], axes, (0, 2), 4
    )
    spurious = problem.refine([1.1, 0.9])
    assert not spurious.is_root and spurious.left_over > 0.1
    root = equations_problem(lambda x, y: [x - 1.0, x + y - 3.0, y - 2.0], axes, (0, 2), 3)
    assert root.refine([1.1, 1.9]).is_root


def test_what_is_missing():
    assert what_is_missing(load_robot("puma560")) == ""
    assert what_is_missing(load_robot("panda")).endswith("this one has 7 joints.")
    assert "joint 'joint_3' of this one slides" in what_is_missing(load_robot("stanford"))
