"""Peers of inverse kinematics that may be missing: each is left out with a printed reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement, tostring

import numpy as np
from peers import constant_transforms, eaik_robot

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.spatial import quaternion_from_matrix, roll_pitch_yaw_from_matrix
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.robots import SerialChain


# So tight that what they return is within the residual that counts as a solution.
LM_TOLERANCE = 1e-13
TRAC_IK_TOLERANCE = 1e-7
TRAC_IK_SECONDS = 0.05


@dataclass(frozen=True)
class Peer:
    """Another library, set up for one arm.

    Attributes
    ----------
    name : str
        Of the library.
    call : callable
        From a target (4, 4) to what the library answers; this is timed.
    read : callable
        From that to solutions (k, n), k = 0 where there are none; this is not.
    batch : callable or None
        From a list of targets to answers, where the library has such a thing.
    """

    name: str
    call: Callable[[Array], Any]
    read: Callable[[Any], Array]
    batch: Callable[[list[Array]], Any] | None = None


def available(*makers: Callable[[], Peer]) -> list[Peer]:
    """Set up peers; say why where one cannot be had."""
    peers = []
    for make in makers:
        try:
            peers.append(make())
        except Exception as error:  # whatever is wrong with a peer, the others are measured
            print(f"left out: {make.__name__}: {type(error).__name__}: {error}", flush=True)
    return peers


def eaik(chain: SerialChain) -> Callable[[], Peer]:
    """EAIK, all solutions of an arm with a closed form."""

    def make_eaik() -> Peer:
        robot = eaik_robot(chain)

        def read(answer: Any) -> Array:
            return np.asarray(answer.Q).reshape(-1, chain.n)

        return Peer("EAIK", robot.IK, read, lambda targets: robot.IK_batched(targets, 1))

    return make_eaik


def ssik_general(chain: SerialChain) -> Callable[[], Peer]:
    """ssik with its native part, all solutions of any arm of six revolute joints."""

    def make_ssik() -> Peer:
        import ssik
        from ssik._native import rr_native_geometry, try_native_solve

        print(f"ssik: equations of {chain.name!r}, some minutes the first time", flush=True)
        arm = ssik.Manipulator.from_transforms(constant_transforms(chain))
        geometry, body = rr_native_geometry(arm.kinbody), arm.kinbody
        options = {"respect_limits": False, "rr_geometry": geometry}
        if try_native_solve("ikgeo.general_6r", body, arm.fk(np.ones(6)), **options) is None:
            raise RuntimeError("its native part cannot be used")

        def call(T: Array) -> Any:
            return try_native_solve("ikgeo.general_6r", body, T, **options)

        return Peer("ssik", call, _read_ssik(chain))

    return make_ssik


def ssik_panda(chain: SerialChain, seed: Array | None = None) -> Callable[[], Peer]:
    """ssik's own Panda: samples of the self-motion, or the solution nearest to a seed."""

    def make_ssik() -> Peer:
        from ssik.prebuilt import franka_panda_ik as arm

        if np.abs(arm.fk(np.ones(7)) - forward_kinematics(chain, np.ones(7))).max() > 1e-9:
            raise RuntimeError("its Panda is another one")
        options = {"respect_limits": False}
        if seed is not None:
            options = {"respect_limits": True, "q_seed": seed, "max_solutions": 1}

        return Peer("ssik", lambda T: arm.solve(T, **options), _read_ssik(chain))

    return make_ssik


def _read_ssik(chain: SerialChain) -> Callable[[Any], Array]:
    return lambda answer: np.array([one.q for one in answer]).reshape(-1, chain.n)


def toolbox(chain: SerialChain, seed: Array) -> Callable[[], Peer]:
    """The Levenberg-Marquardt solver of roboticstoolbox, one solution from a seed."""

    def make_roboticstoolbox() -> Peer:
        import roboticstoolbox as rtb

        transforms = constant_transforms(chain)
        lower, upper = _limits(chain)
        ets = rtb.ETS([])
        for T, low, high in zip(transforms, lower, upper, strict=False):
            ets = ets * rtb.ET.SE3(T) * rtb.ET.Rz(qlim=[low, high])
        ets = ets * rtb.ET.SE3(transforms[-1])

        def read(answer: Any) -> Array:
            return np.asarray(answer.q).reshape(-1, chain.n)[: int(answer.success)]

        return Peer("roboticstoolbox", lambda T: ets.ik_LM(T, q0=seed, tol=LM_TOLERANCE), read)

    return make_roboticstoolbox


def trac_ik(chain: SerialChain, seed: Array, targets: Array) -> Callable[[], Peer]:
    """TRAC-IK by its Python binding, one solution from a seed.

    It wants quaternions, which are made of the targets (m, 4, 4) beforehand.
    """

    def make_trac_ik() -> Peer:
        import pytracik

        rows = quaternion_from_matrix(targets[:, :3, :3]).tolist()
        quaternions = {T.tobytes(): row for T, row in zip(targets, rows, strict=True)}

        speed = pytracik.SolveType.Speed
        urdf, ends = _urdf(chain), (TRAC_IK_SECONDS, TRAC_IK_TOLERANCE, speed)
        solver = pytracik.TRAC_IK("link_0", "tip", urdf, *ends)

        def call(T: Array) -> Array:
            return pytracik.ik(solver, seed, *T[:3, 3].tolist(), *quaternions[T.tobytes()])

        return Peer("TRAC-IK", call, lambda answer: answer[None, 1:][: int(answer[0] >= 0)])

    return make_trac_ik


def _limits(chain: SerialChain) -> tuple[Array, Array]:
    """Return the limits (rad); a turn either way where there is none."""
    return np.maximum(chain.lower, -2.0 * np.pi), np.minimum(chain.upper, 2.0 * np.pi)


def _urdf(chain: SerialChain) -> str:
    """Describe a chain of revolute joints as URDF, from link_0 to tip."""
    robot = Element("robot", name="peer")
    SubElement(robot, "link", name="link_0")
    lower, upper = _limits(chain)
    for i, T in enumerate(constant_transforms(chain)):
        fixed = i == chain.n
        child = "tip" if fixed else f"link_{i + 1}"
        SubElement(robot, "link", name=child)
        kind = "fixed" if fixed else "revolute"
        joint = SubElement(robot, "joint", name=f"joint_{i}", type=kind)
        SubElement(joint, "parent", link=f"link_{i}")
        SubElement(joint, "child", link=child)
        turn = roll_pitch_yaw_from_matrix(T[:3, :3])
        SubElement(joint, "origin", xyz=_numbers(T[:3, 3]), rpy=_numbers(turn))
        if not fixed:
            SubElement(joint, "axis", xyz="0 0 1")
            ends = {"lower": _numbers(lower[i : i + 1]), "upper": _numbers(upper[i : i + 1])}
            SubElement(joint, "limit", effort="1", velocity="1", **ends)
    return tostring(robot, encoding="unicode")


def _numbers(values: Array) -> str:
    return " ".join(map(repr, values.tolist()))
