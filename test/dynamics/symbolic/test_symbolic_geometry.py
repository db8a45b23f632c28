"""Chapters 4 and 9 as expressions: derived from the loop, equal to the numeric functions."""

import numpy as np
import pytest
import sympy
from numpy.testing import assert_allclose

from robomech_ros.dynamics.symbolic import symbolic_closure, symbolic_decoupled
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.equations import (
    closure_equations,
    orientation_equation,
    positioning_equations,
    wrist_centre,
)
from robomech_ros.robots import chain_from_dh, load_robot

ARMS = ("general", "puma560", "parallel")
TWISTS = np.radians([70, -30, 80, 75, -85, 20])


def arm_of(name):
    """A robot, or a table with a spherical wrist."""
    if name == "puma560":
        return load_robot(name)
    a, b = [0.3, 0.5, 0.25, 0, 0, 0], [0.2, 0.1, 0.15, 0.6, 0, 0.1]
    alpha = TWISTS.copy()
    if name == "parallel":
        alpha[0] = 0.0
    return chain_from_dh(a, b, alpha)


def general_arm():
    rng = np.random.default_rng(4)
    return chain_from_dh(
        rng.uniform(0.1, 1, 6),
        rng.uniform(-0.5, 0.5, 6),
        rng.uniform(-3, 3, 6),
        rng.uniform(-3, 3, 6),
    )


def numbers(matrix, values):
    """Evaluate a matrix of expressions at values of its symbols."""
    evaluate = sympy.lambdify(tuple(values), matrix, modules="numpy", cse=True)
    return np.array(evaluate(*values.values()), dtype=float)


def target_values(loop, pose):
    entries = dict(zip(loop.rotation, pose[:3, :3].ravel(), strict=True))
    return loop.parameters.values | entries | dict(zip(loop.position, pose[:3, 3], strict=True))


@pytest.mark.parametrize("parameters", ("names", "numbers"))
@pytest.mark.parametrize("name", ARMS)
def test_the_positioning_problem(name, parameters):
    chain = arm_of(name)
    model = symbolic_decoupled(chain, parameters=parameters)
    pose = forward_kinematics(chain, np.random.default_rng(1).uniform(-3, 3, 6))
    centre = wrist_centre(chain, pose)
    table = chain.dh
    inner = np.linalg.inv(table.base) @ pose @ np.linalg.inv(table.tool)
    found = numbers(model.wrist_centre, target_values(model.loop, inner))
    assert_allclose(found[:, 0], centre, atol=1e-12)
    expected = positioning_equations(chain, centre)
    values = model.loop.parameters.values | dict(zip(model.centre, centre, strict=True))
    for what in ("first", "second", "conic", "quartic"):
        found = numbers(getattr(model, what), values)[0]
        assert_allclose(found, getattr(expected, what), atol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_the_orientation_problem(name):
    chain = arm_of(name)
    model = symbolic_decoupled(chain)
    R = forward_kinematics(chain, np.random.default_rng(2).uniform(-3, 3, 6))[:3, :3]
    expected = orientation_equation(chain, R)
    values = model.loop.parameters.values | dict(zip(model.axis, expected.axis, strict=True))
    assert_allclose(numbers(model.orientation, values)[0], expected.quadratic, atol=1e-12)


def test_the_coefficients_are_those_of_the_book():
    """Term by term, as the page of inverse kinematics has them."""
    model = symbolic_decoupled(arm_of("general"))
    names = "a_1 a_2 a_3 b_1 b_2 b_3 b_4 alpha_1 alpha_2 alpha_3"
    a1, a2, a3, b1, b2, b3, b4, *alphas = sympy.symbols(names, real=True)
    (l1, l2, l3), (m1, m2, m3) = ([f(one) for one in alphas] for f in (sympy.cos, sympy.sin))
    x, y, z = model.centre
    E = a2**2 + a3**2 + b2**2 + b3**2 + b4**2 - a1**2 - x**2 - y**2 - (z - b1) ** 2
    E += 2 * b2 * b3 * l2 + 2 * b2 * b4 * l2 * l3 + 2 * b3 * b4 * l3
    first = [2 * a1 * x, 2 * a1 * y, 2 * a2 * a3 - 2 * b2 * b4 * m2 * m3]
    first += [2 * a3 * b2 * m2 + 2 * a2 * b4 * m3, E]
    J = b2 + b3 * l2 + b4 * l2 * l3 - (z - b1) * l1
    second = [y * m1, -x * m1, -b4 * m2 * m3, a3 * m2, J]
    for ours, theirs in ((model.first, first), (model.second, second)):
        for one, other in zip(ours, theirs, strict=True):
            assert sympy.expand(one - other) == 0
    C, H = first[2], second[2]
    assert sympy.simplify(model.conic[0] - (4 * a1**2 * H**2 + m1**2 * C**2)) == 0


@pytest.mark.parametrize("name", ("random", "diestro", "puma560"))
def test_closure_equations_hold_at_postures(name):
    chain = general_arm() if name == "random" else load_robot(name)
    closure = symbolic_closure(chain)
    assert closure.left.shape == closure.right.shape == (14, 1)
    parameters = closure.loop.parameters
    q = np.random.default_rng(3).uniform(-3, 3, 6)
    table = chain.dh
    pose = forward_kinematics(chain, q)
    inner = np.linalg.inv(table.base) @ pose @ np.linalg.inv(table.tool)
    values = target_values(closure.loop, inner)
    values |= dict(zip(parameters.variables, q + parameters.offsets, strict=True))
    left, right = numbers(closure.left, values), numbers(closure.right, values)
    assert_allclose(left, right, atol=1e-10)
    assert np.abs(left).max() > 0.1
    # The numeric equations, in the frame before joint 3's link and in parts of the arm's size.
    assert np.abs(closure_equations(chain, pose).residual(q)).max() < 1e-13
    # No joint stands on the wrong side, and joint 6 on neither.
    angles = parameters.variables
    assert closure.left.free_symbols.isdisjoint({angles[0], angles[1], angles[5]})
    assert closure.right.free_symbols.isdisjoint(angles[2:])


def test_left_sides_are_products_of_links():
    chain = general_arm()
    closure = symbolic_closure(chain)
    parameters, table = closure.loop.parameters, chain.dh
    angles = np.random.default_rng(5).uniform(-3, 3, 6)
    values = parameters.values | dict(zip(parameters.variables, angles, strict=True))
    matrices = [
        forward_kinematics(chain_from_dh([table.a[i]], [table.b[i]], [table.alpha[i]]), [angles[i]])
        for i in (2, 3, 4)
    ]
    pose = np.linalg.multi_dot(matrices)
    l, p = pose[:3, 2], pose[:3, 3]  # noqa: E741
    expected = [*p, *l, *np.cross(p, l), *((p @ p) * l - 2 * (p @ l) * p), p @ p, p @ l]
    assert_allclose(numbers(closure.left, values)[:, 0], expected, atol=1e-12)


def test_wrong_arguments():
    for derive in (symbolic_decoupled, symbolic_closure):
        with pytest.raises(BadValueError, match="six revolute"):
            derive(load_robot("panda"))
        with pytest.raises(BadValueError, match="names, numbers"):
            derive(load_robot("puma560"), parameters="symbols")
        with pytest.raises(BadValueError, match="chain"):
            derive("puma560")
    with pytest.raises(BadValueError, match="through one point"):
        symbolic_decoupled(load_robot("diestro"))
