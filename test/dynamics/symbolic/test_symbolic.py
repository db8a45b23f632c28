"""Closed forms: readable where the book's are, and equal to the numeric formulations."""

import subprocess
import sys

import numpy as np
import pytest
import sympy
from arms_with_bodies import golden_arm
from formulation_arms import furnished, golden_planar, relative, states

from robomech_ros.cli import main as cli, symbolic as command
from robomech_ros.dynamics.formulations.lagrange import inverse_dynamics_by_lagrange
from robomech_ros.dynamics.formulations.orthogonal_complement import natural_orthogonal_complement
from robomech_ros.dynamics.friction import friction_torque
from robomech_ros.dynamics.symbolic.closed_forms import EXPRESSIONS, symbolic_model
from robomech_ros.dynamics.symbolic.printing import (
    FORMS,
    abbreviated,
    expression_latex,
    expression_source,
    expression_text,
)
from robomech_ros.errors import BadValueError, MissingInertiaError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot

DOWN = (0.0, 0.0, -9.81)


@pytest.fixture(scope="module")
def planar(golden):
    case = golden("dynamics_planar3r")
    return case, symbolic_model(golden_planar(case), gravity=[0.0, -9.81, 0.0])


@pytest.fixture(scope="module")
def six(golden):
    case = golden("dynamics_6r")
    arm = golden_arm(case)
    return case, symbolic_model(arm, gravity=case["gravity"], parameters="numbers")


def test_planar_arm_reads_as_in_books(planar):
    _, model = planar
    assert expression_text(model, "jacobian").splitlines()[9:12] == [
        "J[4, 1] = -a_1*s_1 - a_2*s_12 - a_3*s_123",
        "J[4, 2] = -a_2*s_12 - a_3*s_123",
        "J[4, 3] = -a_3*s_123",
    ]
    text = expression_text(model, "mass_matrix")
    assert text.splitlines()[5] == "I[3, 3] = I_zz3 + a_3**2*m_3 + 2*a_3*m_3*x_3 + m_3*x_3**2"
    used = {one for one in ("c_1", "c_2", "c_3", "c_12", "c_23", "c_123") if f"{one}*" in text}
    assert used == {"c_2", "c_3", "c_23"}
    assert "g*m_3*(a_3 + x_3)" in expression_text(model, "gravity_torque")


def test_golden_planar_torques(planar):
    case, model = planar
    tau = model.compiled("torque")(case["q"], case["qd"], case["qdd"])
    np.testing.assert_allclose(tau, case["tau"], rtol=0, atol=1e-12)
    inertia = model.compiled("mass_matrix")(case["q"])
    np.testing.assert_allclose(inertia, case["M"], rtol=0, atol=1e-12)


def test_golden_torques_of_six_joints(six):
    case, model = six
    tau = model.compiled("torque")(case["q"], case["qd"], case["qdd"])
    np.testing.assert_allclose(tau, case["tau"], rtol=0, atol=case["tolerance"])
    inertia = model.compiled("mass_matrix")(case["q"])
    np.testing.assert_allclose(inertia, case["M"], rtol=0, atol=1e-10)


def test_right_angles_are_exact(six):
    _, model = six
    named = symbolic_model(model.chain, gravity=DOWN)
    for name in ("forward_kinematics", "gravity_torque"):
        assert not named.expression(name).atoms(sympy.Float)
    assert not any("alpha" in str(one) for one in named.forward_kinematics.free_symbols)


@pytest.mark.parametrize("robot", ["puma560", "scara"])
def test_kinematics_and_weights_agree_with_the_numeric_functions(robot):
    arm = furnished(load_robot(robot), 1)
    model = symbolic_model(arm, gravity=DOWN, parameters="numbers")
    q, _, _ = states(arm, 20)
    poses = model.compiled("forward_kinematics")(q)
    np.testing.assert_allclose(poses, forward_kinematics(arm, q), rtol=0, atol=1e-13)
    J = model.compiled("jacobian")(q)
    np.testing.assert_allclose(J, jacobian(arm, q), rtol=0, atol=1e-13)
    held = inverse_dynamics_by_lagrange(arm, q, 0 * q, 0 * q, gravity=DOWN)
    np.testing.assert_allclose(
        model.compiled("gravity_torque")(q), held, rtol=0, atol=1e-10 * np.abs(held).max()
    )


@pytest.mark.parametrize(
    ("kind", "parameters"), [("RPR", "numbers"), ("PRR", "numbers"), ("RP", "names")]
)
def test_torques_of_general_arms_with_friction_and_rotors_agree(random_chain, kind, parameters):
    types = ["RP".index(one) for one in kind]
    arm = furnished(random_chain(3, len(types), types, kind="general"), 5, drives=True)
    gravity = (1.0, -2.0, -9.0)
    model = symbolic_model(arm, gravity=gravity, parameters=parameters)
    q, qd, qdd = states(arm, 100)
    expected = inverse_dynamics_by_lagrange(arm, q, qd, qdd, gravity=gravity)
    assert relative(model.compiled("torque")(q, qd, qdd), expected) < 1e-10
    friction = model.compiled("friction_torque")(q, qd)
    np.testing.assert_allclose(friction, friction_torque(arm, qd), rtol=1e-12)
    inertia = natural_orthogonal_complement(arm, q, qd).generalised_inertia
    np.testing.assert_allclose(model.compiled("mass_matrix")(q), inertia, rtol=1e-10, atol=1e-11)


@pytest.mark.long
def test_torques_of_puma_with_general_bodies_agree_at_many_states():
    arm = furnished(load_robot("puma560"), 1, drives=True)
    model = symbolic_model(arm, gravity=DOWN, parameters="numbers")
    q, qd, qdd = states(arm, 1000)
    expected = inverse_dynamics_by_lagrange(arm, q, qd, qdd, gravity=DOWN)
    assert relative(model.compiled("torque")(q, qd, qdd), expected) < 1e-10


def test_the_coriolis_matrix_leaves_a_skew_difference(planar):
    _, model = planar
    given = model.parameters
    rate = sum(
        (model.mass_matrix.diff(v) * r for v, r in zip(given.variables, given.rates, strict=True)),
        start=sympy.zeros(3, 3),
    )
    difference = rate - 2 * model.coriolis_matrix
    assert (difference + difference.T).applyfunc(sympy.expand) == sympy.zeros(3, 3)


@pytest.mark.parametrize("what", EXPRESSIONS)
def test_python_source_gives_the_numbers(planar, what):
    case, model = planar
    source = expression_source(model, what, "closed")
    names = {}
    exec(compile(source, "source", "exec"), names)
    count = names["closed"].__code__.co_argcount
    given = [*case["q"], *case["qd"], *case["qdd"]][:count]
    expected = model.compiled(what)(case["q"], case["qd"], case["qdd"])
    np.testing.assert_allclose(np.squeeze(names["closed"](*given)), expected, atol=1e-13)


def test_latex_shows_sums_of_angles(planar):
    text = expression_latex(planar[1], "mass_matrix")
    assert text.startswith("\\begin{align*}\nI_{11} &=")
    assert "c_{23}" in text and "I_{zz3}" in text and "theta" not in text


def test_abbreviations_are_told_apart():
    one, two, twelve = (sympy.Symbol(f"theta_{k}", real=True) for k in (1, 2, 12))
    short, _ = abbreviated(sympy.cos(one + two) * sympy.sin(one - two) + sympy.cos(2 * two))
    assert {str(symbol) for symbol in short.free_symbols} == {"c_12", "s_1_m2", "c_22"}
    short, legend = abbreviated(sympy.cos(one + two) + sympy.cos(twelve))
    assert {str(symbol) for symbol in legend} == {"c_1_2", "c_12"}
    angle = sympy.Symbol("alpha_3", real=True)
    assert str(abbreviated(sympy.cos(angle))[0]) == "lambda_3"


def test_wrong_requests_are_refused(planar, random_chain):
    _, model = planar
    with pytest.raises(BadValueError, match="one of forward_kinematics"):
        model.expression("inertia")
    with pytest.raises(BadValueError, match="names, numbers"):
        symbolic_model(model.chain, parameters="letters")
    with pytest.raises(NonFiniteError, match="gravity"):
        symbolic_model(model.chain, gravity=[0, 0, np.nan])
    with pytest.raises(BadValueError, match="chain"):
        symbolic_model("planar3r")
    with pytest.raises(MissingInertiaError, match="joint_1"):
        symbolic_model(random_chain(0, 2)).expression("torque")
    with pytest.raises(WrongSizeError, match="q has shape"):
        model.compiled("jacobian")([0.0, 0.0])
    with pytest.raises(BadValueError, match="a name of Python's"):
        expression_source(model, "jacobian", "import")


def test_command_prints_every_form(capsys):
    for form in ("", "--latex", "--python"):
        args = ["symbolic", "--robot", "planar3r", "--what", "forward_kinematics", form]
        assert cli.main([one for one in args if one]) == 0
        assert ("c_{123}" if form == "--latex" else "123" if not form else "numpy.array") in (
            capsys.readouterr().out
        )
    assert set(command.EXPRESSIONS) == set(EXPRESSIONS) and set(FORMS) == {
        "text",
        "latex",
        "python",
    }
    assert cli.main(["symbolic", "--robot", "nobody"]) == 2
    assert "unknown robot" in capsys.readouterr().err


def test_command_tells_where_sympy_is_missing(tmp_path):
    (tmp_path / "sitecustomize.py").write_text(
        "import importlib.util as u\nold = u.find_spec\n"
        "u.find_spec = lambda name, *a: None if name == 'sympy' else old(name, *a)\n"
    )
    program = (
        "import sitecustomize, sys\nfrom robomech_ros.cli.main import main\n"
        "sys.exit(main(['symbolic', '--robot', 'planar3r']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{program}"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1 and "robomech_ros[symbolic]" in done.stderr
