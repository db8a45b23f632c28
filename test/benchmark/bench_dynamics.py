"""Dynamics of a six-joint arm against Pinocchio, and a simulated minute under a controller.

Both sides are given the same states and give the same results; Pinocchio's call returns what ours
returns, but for the mass matrix, of which it fills the upper triangle.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pinocchio
from peers import Array, constant_transforms
from table import Row
from timing import Work, interleave

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics import (
    derivatives as dynamics_derivatives,
    forward as dynamics_forward,
    inverse as dynamics_inverse,
    mass as dynamics_mass,
)
from robomech_ros.dynamics import (
    ControlledArm,
    FloatingChain,
    forward_dynamics,
    gravity_torque,
    inverse_dynamics,
    inverse_dynamics_derivatives,
    mass_matrix,
)
from robomech_ros.dynamics.model import GRAVITY, dynamic_model, surroundings
from robomech_ros.robots import Body, SerialChain, load_robot

BATCH = 500
SINGLES = 50
AGREEMENT = 1e-9
KERNEL_RATIO = 1.0
BATCH_RATIO = 0.5
FLOATING_RATIO = 1.5
ABOVE_KERNEL = 2.0
MINUTE = 60.0


def rows() -> list[Row]:
    """Measure on the PUMA 560 and return the rows of the table."""
    chain = load_robot("puma560")
    n = chain.n
    model, peer = dynamic_model(chain), pinocchio_model(chain)
    data = peer.createData()
    states = np.random.default_rng(560).uniform(-2.0, 2.0, (3, BATCH, n))
    around = surroundings((n,), GRAVITY)
    out, M, matrices = np.empty(n), np.empty((n, n)), np.empty((3, n, n))
    inverse = direct(dynamics_inverse.inverse_dynamics_one)
    gravity = direct(dynamics_inverse.gravity_torque_one)
    forward = direct(dynamics_forward.forward_dynamics_one)
    mass = direct(dynamics_mass.mass_matrix_one)
    derivatives = direct(dynamics_derivatives.inverse_derivatives_one)

    def peer_mass(q: Array) -> Array:
        upper = np.triu(pinocchio.crba(peer, data, q))
        return upper + np.triu(upper, 1).T

    cases: list[tuple[str, int, Callable, Callable, Callable]] = [
        (
            "inverse dynamics",
            3,
            lambda *s: inverse(model, *s, around, out),
            inverse_dynamics,
            lambda *s: pinocchio.rnea(peer, data, *s),
        ),
        (
            "mass matrix",
            1,
            lambda q: mass(model, q, M),
            mass_matrix,
            lambda q: pinocchio.crba(peer, data, q),
        ),
        (
            "forward dynamics",
            3,
            lambda *s: forward(model, *s, around, out),
            forward_dynamics,
            lambda *s: pinocchio.aba(peer, data, *s),
        ),
        (
            "gravity",
            1,
            lambda q: gravity(model, q, around, out),
            gravity_torque,
            lambda q: pinocchio.computeGeneralizedGravity(peer, data, q),
        ),
        (
            "derivatives",
            3,
            lambda *s: derivatives(model, *s, around, matrices),
            inverse_dynamics_derivatives,
            lambda *s: pinocchio.computeRNEADerivatives(peer, data, *s),
        ),
    ]
    found = []
    for name, count, kernel, public, peer_call in cases:
        given = [tuple(part[k] for part in states[:count]) for k in range(SINGLES)]
        with_chain = [(chain, *state) for state in given]
        whole = states[:count]
        ours, theirs = public(chain, *given[0]), peer_call(*given[0])
        if name == "mass matrix":
            theirs = peer_mass(*given[0])
        if name == "derivatives":
            ours, theirs = ours.by_q, theirs[0]
        if np.abs(ours - theirs).max() > AGREEMENT * np.abs(theirs).max():
            raise SystemExit(f"{name}: ours and Pinocchio's differ")
        works = {
            "kernel": Work(lambda g=given, f=kernel: _each(f, g), SINGLES),
            "public": Work(lambda g=with_chain, f=public: _each(f, g), SINGLES),
            "batch": Work(lambda w=whole, f=public: f(chain, *w), BATCH),
            "peer": Work(lambda g=given, f=peer_call: _each(f, g), SINGLES),
        }
        times = interleave(works)
        against = {"peer": times["peer"].median, "peer_name": "Pinocchio"}
        bound = times["kernel"].median + ABOVE_KERNEL
        for what, key, target in (
            ("kernel from Python", "kernel", {"ratio_limit": KERNEL_RATIO}),
            ("public function", "public", {"limit": round(bound, 1)}),
            ("batch, a state", "batch", {"ratio_limit": BATCH_RATIO}),
        ):
            timing = times[key]
            spread = timing.spread
            found.append(Row(f"{name}, {what}", timing.median, spread=spread, **against, **target))
    return [*found, *floating(load_robot("canadarm2")), simulated_minute(chain)]


def floating(arm: SerialChain) -> list[Row]:
    """Time the public functions of an arm on a free base against those of the fixed arm."""
    robot = FloatingChain(arm, Body(9000.0, [0.0, 0.0, -2.0], 7e4 * np.eye(3)))
    q, (u, du) = arm.home(), np.random.default_rng(7).uniform(-0.1, 0.1, (2, 6 + arm.n))
    qd, qdd = u[6:].copy(), du[6:].copy()
    found = []
    for name, free, fixed in (
        ("inverse", robot.inverse, inverse_dynamics),
        ("forward", robot.forward, forward_dynamics),
    ):
        works = {
            "free": Work(lambda f=free: _each(f, [(q, u, du)] * SINGLES), SINGLES),
            "fixed": Work(lambda f=fixed: _each(f, [(arm, q, qd, qdd)] * SINGLES), SINGLES),
        }
        times = interleave(works)
        row = Row(
            f"{name} dynamics of Canadarm2 on a free base",
            times["free"].median,
            spread=times["free"].spread,
            peer=times["fixed"].median,
            peer_name="on a fixed base",
            ratio_limit=FLOATING_RATIO,
        )
        found.append(row)
    return found


def _each(function: Callable, arguments: list[tuple]) -> None:
    """Call a function with each of some arguments; its results are not kept, as in a controller."""
    for given in arguments:
        function(*given)


def pinocchio_model(chain: SerialChain) -> pinocchio.Model:
    """Return Pinocchio's model of a chain with bodies and rotors."""
    model, joint = pinocchio.Model(), 0
    placed = constant_transforms(chain)
    for index, name in enumerate(chain.joint_names):
        kind = pinocchio.JointModelPZ() if chain.types[index] else pinocchio.JointModelRZ()
        T, body = placed[index], chain.bodies[index]
        joint = model.addJoint(joint, kind, pinocchio.SE3(T[:3, :3], T[:3, 3]), name)
        inertia = pinocchio.Inertia(body.mass, np.array(body.com), np.array(body.inertia))
        model.appendBodyToJoint(joint, inertia, pinocchio.SE3.Identity())
    model.armature = np.array([drive.reflected_inertia for drive in chain.drives])
    return model


def simulated_minute(chain: SerialChain) -> Row:
    """Time a minute of motion under computed torque at 1 kHz, friction included."""
    t = np.arange(round(1000 * MINUTE))[:, None] * 1e-3
    w = np.linspace(0.7, 1.7, chain.n)
    wanted = np.stack(
        (
            chain.midrange() + 0.5 * np.sin(w * t),
            0.5 * w * np.cos(w * t),
            -0.5 * w**2 * np.sin(w * t),
        ),
        axis=1,
    )
    servo, seconds = ControlledArm(chain), []
    for _ in range(5):
        q, qd = wanted[0, 0].copy(), wanted[0, 1].copy()
        begin = time.perf_counter()
        motion = servo.run(q, qd, wanted)
        seconds.append(time.perf_counter() - begin)
        if motion.reason:
            raise SystemExit(motion.reason)
    return Row("a minute under computed torque at 1 kHz", float(np.median(seconds)), "s", limit=1.0)
