"""Motions of links and joint wrenches of the recursion, against Pinocchio and the golden arm."""

import json
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import ROBOTS, golden_arm, pinocchio_of, with_bodies
from numpy.testing import assert_allclose

from robomech_ros.dynamics import inverse_dynamics, natural_orthogonal_complement, newton_euler
from robomech_ros.errors import BadValueError, MissingInertiaError, NonFiniteError, WrongSizeError
from robomech_ros.robots import chain_from_dh, load_robot

GOLDEN = Path(__file__).parents[2] / "data" / "golden"
KINDS = ("R", "P", "RPRPRR", "RRRRRRR")
GRAVITY = (0.5, -1.0, -9.0)
WRENCH = np.array([1.0, -2.0, 3.0, -4.0, 5.0, 6.0])
BASE = {
    "base_twist": [0.3, -0.2, 0.5, 0.1, 0.4, -0.6],
    "base_twist_rate": [-0.4, 0.7, 0.2, 1.1, -0.3, 0.8],
}


@pytest.fixture(params=[*ROBOTS, *KINDS])
def arm(request, random_chain):
    if request.param in ROBOTS:
        return load_robot(request.param)
    types = ["RP".index(kind) for kind in request.param]
    return with_bodies(random_chain(7, len(types), types), 3)


def states(arm, count):
    return np.random.default_rng(1).uniform(-1.5, 1.5, (3, count, arm.n))


def test_torques_are_those_of_the_kernel(arm):
    q, qd, qdd = states(arm, 20)
    given = {"gravity": GRAVITY, "tip_wrench": WRENCH}
    for base in ({}, BASE):
        ours = newton_euler(arm, q, qd, qdd, **given, **base)
        expected = inverse_dynamics(arm, q, qd, qdd, **given, **base)
        assert np.abs(ours.torques - expected).max() < 1e-12 * (1.0 + np.abs(expected).max())
        one = newton_euler(arm, q[3], qd[3], qdd[3], **given, **base)
        for name in ("twists", "twist_rates", "joint_wrenches", "torques"):
            assert_allclose(getattr(one, name), getattr(ours, name)[3], atol=1e-10)


def test_motions_and_wrenches_are_those_of_pinocchio(arm):
    """Its recursion keeps link motions and joint wrenches too, in the axes of the links."""
    model = pinocchio_of(arm, GRAVITY)
    data = model.createData()
    for q, qd, qdd in states(arm, 3).swapaxes(0, 1):
        ours = newton_euler(arm, q, qd, qdd, gravity=GRAVITY)
        pinocchio.rnea(model, data, q, qd, qdd)
        pinocchio.forwardKinematics(model, data, q, qd, qdd)
        for i in range(arm.n):
            place = data.oMi[i + 1]
            f = place.rotation @ data.f[i + 1].linear
            n = place.rotation @ data.f[i + 1].angular
            assert_allclose(ours.joint_wrenches[i], [*n, *f], atol=1e-9)
            at = pinocchio.SE3(np.eye(3), np.array(arm.bodies[i].com))
            velocity = at.actInv(data.v[i + 1])
            acceleration = pinocchio.Motion(at.actInv(data.a[i + 1]).vector)
            linear = acceleration.linear + np.cross(velocity.angular, velocity.linear)
            R = place.rotation
            assert_allclose(
                ours.twists[i], [*(R @ velocity.angular), *(R @ velocity.linear)], atol=1e-10
            )
            assert_allclose(
                ours.twist_rates[i], [*(R @ acceleration.angular), *(R @ linear)], atol=1e-9
            )


def test_twists_are_those_of_the_orthogonal_complement(arm):
    q, qd, qdd = states(arm, 5)
    ours = newton_euler(arm, q, qd, qdd)
    theirs = natural_orthogonal_complement(arm, q, qd)
    assert_allclose(ours.twists.reshape(5, -1), theirs.twists, atol=1e-12)
    rates = np.einsum("kij,kj->ki", theirs.T, qdd) + np.einsum("kij,kj->ki", theirs.T_dot, qd)
    assert_allclose(ours.twist_rates.reshape(5, -1), rates, atol=1e-10)


def test_each_link_is_in_balance_on_a_moving_base(arm):
    """Newton's and Euler's equations of each body by itself, with the wrenches at both ends."""
    q, qd, qdd = (one[0] for one in states(arm, 1))
    found = newton_euler(arm, q, qd, qdd, gravity=GRAVITY, tip_wrench=WRENCH, **BASE)
    bodies = found.bodies
    outward = np.vstack((found.joint_wrenches[1:], -WRENCH[None]))
    ends = np.vstack((bodies.origins[1:], bodies.tip[None]))
    for i in range(arm.n):
        force = found.joint_wrenches[i, 3:] - outward[i, 3:] + bodies.masses[i] * np.array(GRAVITY)
        assert_allclose(force, bodies.masses[i] * found.twist_rates[i, 3:], atol=1e-9)
        moment = found.joint_wrenches[i, :3] - outward[i, :3]
        moment += np.cross(bodies.origins[i] - bodies.centres[i], found.joint_wrenches[i, 3:])
        moment -= np.cross(ends[i] - bodies.centres[i], outward[i, 3:])
        omega, inertia = found.twists[i, :3], bodies.inertias[i]
        spin = inertia @ found.twist_rates[i, :3] + np.cross(omega, inertia @ omega)
        assert_allclose(moment, spin, atol=1e-9)


def test_the_golden_arm():
    case = json.loads((GOLDEN / "dynamics_6r.json").read_text())
    found = newton_euler(
        golden_arm(case), case["q"], case["qd"], case["qdd"], gravity=case["gravity"]
    )
    assert_allclose(found.torques, case["tau"], atol=1e-8)


def test_wrong_arguments():
    puma, rest = load_robot("puma560"), [0.0] * 6
    with pytest.raises(WrongSizeError, match="tip_wrench"):
        newton_euler(puma, rest, rest, rest, tip_wrench=[1.0])
    with pytest.raises(WrongSizeError, match="gravity"):
        newton_euler(puma, rest, rest, rest, gravity=9.81)
    with pytest.raises(NonFiniteError, match="qdd"):
        newton_euler(puma, rest, rest, [np.nan] * 6)
    with pytest.raises(BadValueError, match="chain"):
        newton_euler("puma560", rest, rest, rest)
    bare = chain_from_dh([0.1], [0.2], [0.3])
    with pytest.raises(MissingInertiaError):
        newton_euler(bare, [0.0], [0.0], [0.0])
