"""All formulations agree with each other and with Pinocchio, and with the golden numbers."""

from itertools import combinations

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import ROBOTS, golden_arm, pinocchio_of
from formulation_arms import GRAVITY, furnished, golden_planar, relative, states

from robomech_ros.dynamics import METHODS, forward_dynamics, friction_torque, inverse_dynamics
from robomech_ros.dynamics.formulations.dynamics_by_complement import (
    forward_dynamics_by_cholesky,
    forward_dynamics_by_reflections,
    inverse_dynamics_by_orthogonal_complement,
)
from robomech_ros.dynamics.formulations.kane import (
    forward_dynamics_by_kane,
    inverse_dynamics_by_kane,
)
from robomech_ros.dynamics.formulations.lagrange import (
    forward_dynamics_by_lagrange,
    inverse_dynamics_by_lagrange,
)
from robomech_ros.errors import (
    BadValueError,
    MissingInertiaError,
    NonFiniteError,
    RobomechError,
    WrongSizeError,
)
from robomech_ros.robots import load_robot

INVERSE = (
    inverse_dynamics_by_orthogonal_complement,
    inverse_dynamics_by_lagrange,
    inverse_dynamics_by_kane,
)
FORWARD = (
    forward_dynamics_by_cholesky,
    forward_dynamics_by_reflections,
    forward_dynamics_by_lagrange,
    forward_dynamics_by_kane,
)
WRENCH = (1.0, -2.0, 3.0, -4.0, 5.0, 6.0)
KINDS = ("R", "P", "RP", "PR", "RRR", "RPRPRR", "PPPRRR", "RRRRRRR")


@pytest.fixture(scope="module", params=[*ROBOTS, *KINDS])
def arm(request, random_chain):
    """A robot of the library, or a random chain with bodies, friction and rotors."""
    if request.param in ROBOTS:
        return load_robot(request.param)
    types = ["RP".index(kind) for kind in request.param]
    return furnished(random_chain(7, len(types), types), 3, drives=True)


def agree_pairwise(arm, count):
    q, qd, qdd = states(arm, count)
    given = {"gravity": GRAVITY, "tip_wrench": WRENCH}
    torques = [inverse(arm, q, qd, qdd, **given) for inverse in INVERSE]
    torques.append(inverse_dynamics(arm, q, qd, qdd, **given))
    for one, other in combinations(torques, 2):
        assert relative(one, other) < 1e-10
    accelerations = [forward(arm, q, qd, torques[0], **given) for forward in FORWARD]
    accelerations += [
        forward_dynamics(arm, q, qd, torques[0], method=method, **given) for method in METHODS
    ]
    for one, other in combinations([qdd, *accelerations], 2):
        assert relative(one, other) < 1e-10


def test_agree_pairwise(arm):
    agree_pairwise(arm, 100)


@pytest.mark.long
def test_agree_pairwise_at_many_states(arm):
    agree_pairwise(arm, 1000)


def test_formulations_are_chosen_by_name(arm):
    q, qd, qdd = states(arm, 5)
    given = {"gravity": GRAVITY, "tip_wrench": WRENCH}
    names = ("orthogonal-complement", "lagrange", "kane")
    for name, inverse in zip(names, INVERSE, strict=True):
        torques = inverse_dynamics(arm, q, qd, qdd, method=name, **given)
        np.testing.assert_array_equal(torques, inverse(arm, q, qd, qdd, **given))
    names = ("reflections", "lagrange", "kane")
    for name, forward in zip(names, FORWARD[1:], strict=True):
        accelerations = forward_dynamics(arm, q, qd, qdd, method=name, **given)
        np.testing.assert_array_equal(accelerations, forward(arm, q, qd, qdd, **given))


def test_a_formulation_for_bases_at_rest_refuses_one_that_moves():
    puma = load_robot("puma560")
    q, qd, qdd = states(puma, 1)
    with pytest.raises(BadValueError, match="method is 'kane'.*bases that move"):
        inverse_dynamics(puma, q, qd, qdd, method="kane", base_twist=[0.1] * 6)
    with pytest.raises(BadValueError, match="newton-euler.*kane"):
        inverse_dynamics(puma, q, qd, qdd, method="euler")


def test_agree_with_pinocchio(arm):
    model = pinocchio_of(arm, GRAVITY)
    data = model.createData()
    q, qd, qdd = states(arm, 100)
    theirs = [pinocchio.rnea(model, data, *state).copy() for state in zip(q, qd, qdd, strict=True)]
    for inverse in INVERSE:
        assert relative(inverse(arm, q, qd, qdd, gravity=GRAVITY), theirs) < 1e-10
    theirs = [pinocchio.aba(model, data, *state).copy() for state in zip(q, qd, qdd, strict=True)]
    for forward in FORWARD:
        assert relative(forward(arm, q, qd, qdd, gravity=GRAVITY), theirs) < 1e-10


def test_no_method_of_a_robot_with_friction_includes_it():
    """``forward_dynamics(method="cholesky")`` left it out, ``forward_dynamics_by_cholesky`` not."""
    puma = load_robot("puma560")
    q, qd, tau = states(puma, 20)
    assert np.abs(friction_torque(puma, qd)).min() > 0.01
    compiled = forward_dynamics(puma, q, qd, tau, method="cholesky")
    for forward in FORWARD:
        assert relative(forward(puma, q, qd, tau), compiled) < 1e-12
    for inverse in INVERSE:
        assert relative(inverse(puma, q, qd, compiled), tau) < 1e-11


@pytest.mark.parametrize("inverse", INVERSE)
def test_golden_torques(golden, inverse):
    case = golden("dynamics_6r")
    tau = inverse(golden_arm(case), case["q"], case["qd"], case["qdd"], gravity=case["gravity"])
    np.testing.assert_allclose(tau, case["tau"], rtol=0, atol=case["tolerance"])
    case = golden("dynamics_planar3r")
    down = [0.0, -case["params"]["g"], 0.0]
    tau = inverse(golden_planar(case), case["q"], case["qd"], case["qdd"], gravity=down)
    np.testing.assert_allclose(tau, case["tau"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("function", [*INVERSE, *FORWARD])
def test_a_batch_is_its_states_and_wrong_input_is_named(golden, function):
    arm = golden_arm(golden("dynamics_6r"))
    q, qd, third = states(arm, 6).reshape(3, 2, 3, 6)
    many = function(arm, q, qd, third, gravity=GRAVITY)
    assert many.shape == (2, 3, 6)
    one = function(arm, q[1, 2], qd[1, 2], third[1, 2], gravity=GRAVITY)
    np.testing.assert_allclose(many[1, 2], one, rtol=1e-13, atol=1e-13)
    with pytest.raises(WrongSizeError, match=r"qd has shape \(6,\), expected \(2, 3, 6\)"):
        function(arm, q, qd[0, 0], third, gravity=GRAVITY)
    with pytest.raises(NonFiniteError, match="qd of joint 'joint_2'"):
        function(arm, q[0, 0], [0, np.nan, 0, 0, 0, 0], third[0, 0], gravity=GRAVITY)
    with pytest.raises(WrongSizeError, match="gravity"):
        function(arm, q, qd, third, gravity=[0, -9.81])
    with pytest.raises(WrongSizeError, match="tip_wrench"):
        function(arm, q, qd, third, gravity=GRAVITY, tip_wrench=[0, 1])
    with pytest.raises(BadValueError, match="chain"):
        function("arm", q, qd, third, gravity=GRAVITY)
    for value in (None, "x", [], {}, object(), 1e400, [[1.0]], 2 + 1j):
        with pytest.raises(RobomechError):
            function(arm, q, qd, value, gravity=GRAVITY)


@pytest.mark.parametrize("function", [*INVERSE, *FORWARD])
def test_missing_inertias_are_named(random_chain, function):
    bare = random_chain(0, 3)
    with pytest.raises(MissingInertiaError, match="joint_1, joint_2, joint_3"):
        function(bare, [0] * 3, [0] * 3, [0] * 3, gravity=GRAVITY)
