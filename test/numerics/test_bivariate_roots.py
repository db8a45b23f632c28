"""Equations in two unknowns: curves, crossings and roots."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import root

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics.equations import closure_equations
from robomech_ros.numerics import bivariate, refine_root
from robomech_ros.robots import chain_from_dh

GOLDEN = Path(__file__).parents[1] / "data/golden"
BOX = [[-3.0, 3.0], [-3.0, 3.0]]


def circle_and_hyperbola(x, y):
    return [x**2 + y**2 - 4.0, x * y - 1.0]


def waves(x, y):
    return [np.cos(3 * x) * np.sin(2 * y) + 0.1, np.sin(x + y) - 0.3 * np.cos(x)]


def test_circle_and_hyperbola():
    found = bivariate(circle_and_hyperbola, BOX)
    big, small = np.sqrt(2.0 + np.sqrt(3.0)), np.sqrt(2.0 - np.sqrt(3.0))
    expected = [[-big, -small], [-small, -big], [small, big], [big, small]]
    np.testing.assert_allclose(found.roots, expected, atol=1e-14)
    assert found.is_root.all()
    assert [len(pieces) for pieces in found.curves] == [1, 2]
    np.testing.assert_allclose(np.hypot(*found.curves[0][0].T), 2.0, atol=2e-3)
    # The gradients are (2 x, 2 y) and (y, x).
    (x, y), (u, v) = np.array(expected).T, np.array(expected).T[::-1]
    across = np.arctan2(np.abs(x * v - y * u), np.abs(x * u + y * v))
    np.testing.assert_allclose(found.angles, across, atol=1e-8)


def test_a_third_equation_tells_roots_from_spurious_crossings():
    shift = np.sqrt(2.0 + np.sqrt(3.0)) - np.sqrt(2.0 - np.sqrt(3.0))
    found = bivariate(lambda x, y: [*circle_and_hyperbola(x, y), x - y - shift], BOX)
    assert found.is_root.tolist() == [False, True, False, True]
    np.testing.assert_allclose(found.roots, found.crossings[found.is_root], atol=1e-14)
    assert found.residuals.max() < 1e-14


def test_curves_that_touch_have_one_root():
    found = bivariate(lambda x, y: [x**2 + y**2 - 4.0, y - 2.0 + 0.0 * x], BOX)
    np.testing.assert_allclose(found.roots, [[0.0, 2.0]], atol=1e-4)
    assert found.angles[0] < 1e-4
    assert not len(bivariate(lambda x, y: [x**2 + y**2 - 4.0, y - 2.1 + 0.0 * x], BOX).roots)


def test_as_many_as_a_search_from_random_points_finds():
    found = bivariate(waves, period=2.0 * np.pi)
    rng = np.random.default_rng(0)
    ends = [root(lambda p: waves(*p), rng.uniform(-np.pi, np.pi, 2), tol=1e-13) for _ in range(600)]
    others = {
        tuple(np.round((end.x + np.pi) % (2.0 * np.pi) - np.pi, 6))
        for end in ends
        if np.abs(waves(*end.x)).max() < 1e-10
    }
    np.testing.assert_allclose(found.roots, sorted(others), atol=1e-6)


@pytest.mark.parametrize("size", [1e-200, 1.0, 1e200])
def test_the_size_of_equations_means_nothing(size):
    found = bivariate(lambda x, y: [size * (x - 0.3), size * (y - 0.4)], BOX)
    np.testing.assert_allclose(found.roots, [[0.3, 0.4]], atol=1e-12)


def test_a_root_on_the_seam_of_a_turn_stands_once():
    found = bivariate(lambda x, y: [np.sin(x), np.sin(y - x)], period=2.0 * np.pi)
    assert len(found.roots) == 4
    assert len(bivariate(lambda x, y: [np.sin(x), np.sin(y - x)]).roots) == 9


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "postures"),
    [("tsai_morgan_3", 12), ("manocha_code_ex2", 4), ("fanuc_arcmate_generic", 8)],
)
def test_the_minors_of_a_general_arm(name, postures):
    """All postures are common roots of the minors of the six equations in joints 4 and 5."""
    case = json.loads((GOLDEN / f"ik6r_{name}.json").read_text(encoding="utf-8"))
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = case["R"], case["p"]
    arm = chain_from_dh(case["a"], case["b"], case["alpha"])
    free = closure_equations(arm, pose).free
    rows = np.array(list(itertools.combinations(range(6), 3)))

    def minors(x, y):
        circles = [np.array([np.cos(a), np.sin(a), np.ones_like(a)]) for a in (x, y)]
        G = np.einsum("eijk,j...,k...->...ei", free, *circles)
        return np.moveaxis(np.linalg.det(G[..., rows, :]), -1, 0)

    found = bivariate(minors, pair=(0, 19), period=2.0 * np.pi)
    assert len(found.roots) == postures
    assert len(found.crossings) > postures or name == "fanuc_arcmate_generic"
    for q in case["solutions"]:
        away = np.abs((found.roots - q[3:5] + np.pi) % (2.0 * np.pi) - np.pi).max(axis=1)
        assert away.min() < 1e-9
    rough = found.roots[0] + 0.02
    end = refine_root(minors, rough)
    assert end.converged
    np.testing.assert_allclose(end.x, found.roots[0], atol=1e-12)
    np.testing.assert_array_equal(end.path[[0, -1]], [rough, end.x])
    assert len(end.path) == end.iterations + 1


@pytest.mark.parametrize(
    ("changes", "error", "text"),
    [
        ({"equations": 3}, BadValueError, "equations is 3, expected a function of x and y"),
        ({"bounds": [0.0, 1.0]}, WrongSizeError, "bounds"),
        ({"bounds": [[0.0, 1.0], [2.0, 1.0]]}, BadValueError, "a least value and a greater one"),
        ({"bounds": [[0.0, np.nan], [2.0, 3.0]]}, NonFiniteError, "bounds"),
        ({"steps": 7}, BadValueError, "steps is 7, expected a whole number from 8 to 4096"),
        ({"steps": 10.5}, BadValueError, "steps"),
        ({"pair": (0, 2)}, BadValueError, "two different numbers of equations from 0 to 1"),
        ({"pair": (1, 1)}, BadValueError, "pair"),
        ({"pair": None}, BadValueError, "pair"),
        ({"pair": (0, 1.9)}, BadValueError, "pair"),
        ({"tolerance": np.nan}, BadValueError, "tolerance"),
        ({"tolerance": "x"}, BadValueError, "tolerance"),
        ({"period": -1.0}, BadValueError, "period"),
        ({"equations": lambda x, y: [x]}, WrongSizeError, "equations"),
        ({"equations": lambda x, y: [np.sqrt(x), y]}, NonFiniteError, "equations"),
        ({"equations": lambda x, y: [x, 0.0 * y]}, BadValueError, "does not vanish everywhere"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_wrong_arguments(changes, error, text):
    given = {"equations": circle_and_hyperbola, "bounds": BOX, **changes}
    with pytest.raises(error, match=text):
        bivariate(given.pop("equations"), **given)


def test_wrong_estimates():
    with pytest.raises(WrongSizeError, match="estimate"):
        refine_root(circle_and_hyperbola, [1.0, 2.0, 3.0])
    with pytest.raises(BadValueError, match="a function of x and y"):
        refine_root(None, [1.0, 2.0])
