"""Parallel robots: all poses of six-legged platforms, one that is followed, and single kernels.

No library on PyPI finds all poses in doubles; goals are the figures of a prototype.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
from table import Row
from timing import Work, interleave

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.parallel import delta, newton
from robomech_ros.parallel import ParallelDynamics, load_parallel

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parallel"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parallel" / "dynamics"))
from platforms import platform, random_pose
from tree_of_pinocchio import TreeOfPinocchio

# Microseconds for all poses of one request.
ALL_POSES = {"general": 600.0, "hexapod": 540.0, "planar": 700.0, "6-3": 430.0, "3-3": 480.0}
FORTY = [1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071]
FORTY_LIMIT, KERNEL_LIMIT = 530.0, 2.0
INVERSE_LIMIT = 20.0
# What a controller of 500 Hz can spend on one of them, in a tenth of its period.
CYCLE_LIMIT = 200.0
REQUESTS, CALLS = 20, 100


def rows() -> list[Row]:
    """Measure and return the rows of the table."""
    found = [_all_poses(kind, limit) for kind, limit in ALL_POSES.items()]
    forty = load_parallel("dietmaier")
    what = "all 40 poses of Dietmaier's platform"
    found.append(_row(what, lambda: forty.direct(FORTY), 1, FORTY_LIMIT))
    return [*found, *_followed(), *_small(), *_kernels(), *_loops(), *_dynamics()]


def _row(what: str, call: Callable[[], object], units: int, limit: float | None = None) -> Row:
    time = interleave({"ours": Work(call, units)}, rounds=101)["ours"]
    return Row(what, time.median, spread=time.spread, limit=limit)


def _all_poses(kind: str, limit: float) -> Row:
    robot, rng = platform(kind, 1), np.random.default_rng(2)
    requests = [robot.inverse(random_pose(robot, rng)) for _ in range(REQUESTS)]
    assert all(robot.direct(lengths).complete for lengths in requests)
    turn = iter(range(10**9))

    def call() -> Any:
        return robot.direct(requests[next(turn) % REQUESTS])

    return _row(f"all poses of a {kind} platform, median request", call, 1, limit)


def _followed() -> list[Row]:
    robot = load_parallel("hexapod")
    T = np.eye(4)
    T[2, 3] = 0.508
    lengths = robot.inverse(T) + 1e-3
    assert robot.follow(lengths, T).certified
    return [_row("a pose followed by 1 mm and certified, one checked call",
                 lambda: robot.follow(lengths, T), 1)]  # fmt: skip


def _small() -> list[Row]:
    """Direct kinematics of the small robots, public calls."""
    calls = {
        "Delta, both modes": (load_parallel("delta"), [0.1, 0.2, 0.3]),
        "planar 3-RPR, six modes": (load_parallel("planar_3rpr"), [14.98, 15.38, 12.0]),
        "agile eye, eight modes": (load_parallel("agile_eye"), [0.1, 0.2, 0.3]),
    }
    return [
        _row(f"{what}, one checked call", lambda r=robot, q=q: r.direct(q), 1)  # type: ignore[misc]
        for what, (robot, q) in calls.items()
    ]


def _kernels() -> list[Row]:
    """Single kernels, a hundred calls each."""
    hexapod = load_parallel("hexapod")
    poses = np.tile(np.eye(4), (CALLS, 1, 1))
    lengths = np.empty((CALLS, 6))
    points = hexapod.base_points, hexapod.platform_points
    robot = load_parallel("delta")
    geometry = np.array([robot.base_radius, robot.platform_radius, robot.arm, robot.forearm])
    place, q = np.array([0.1, 0.2, -0.9]), np.array([0.1, 0.2, 0.3])
    angles, excess, places, report = np.empty((3, 2)), np.empty(3), np.empty((2, 3)), np.empty(1)
    inverse, forward = direct(delta.delta_angles), direct(delta.delta_points)

    def both() -> None:
        for _ in range(CALLS):
            inverse(geometry, robot.azimuths, place, angles, excess)

    def modes() -> None:
        for _ in range(CALLS):
            forward(geometry, robot.azimuths, q, places, report)

    return [
        _row("kernel: leg lengths of a pose", lambda: newton.leg_lengths(*points, poses, lengths),
             CALLS, KERNEL_LIMIT),
        _row("kernel: Delta, all angles of a place", both, CALLS, KERNEL_LIMIT),
        _row("kernel: Delta, both places of three angles", modes, CALLS, KERNEL_LIMIT),
    ]  # fmt: skip


def _loops() -> list[Row]:
    """All 36 joints of a hexapod in one cycle of a controller."""
    mechanism = load_parallel("hexapod").mechanism
    q = mechanism.home()
    drives, speeds = q[mechanism.drive_index] + 1e-3, np.linspace(0.1, 0.2, 6)
    qd, _ = mechanism.rates(q, speeds)
    assert mechanism.close(drives, q).status == 0
    return [
        _row("hexapod: all joints for drives moved by 1 mm",
             lambda: mechanism.close(drives, q), 1, CYCLE_LIMIT),
        _row("hexapod: rates of all joints", lambda: mechanism.rates(q, speeds), 1, CYCLE_LIMIT),
        _row("hexapod: accelerations of all joints",
             lambda: mechanism.accelerations(q, qd, speeds), 1, CYCLE_LIMIT),
    ]  # fmt: skip


def _dynamics() -> list[Row]:
    """Dynamics of the hexapod over its drives, beside Pinocchio with its loops as constraints."""
    mechanism = load_parallel("hexapod").mechanism
    robot, q = ParallelDynamics(mechanism), mechanism.home()
    rates, efforts = 0.1 * np.ones(6), robot.gravity(q)
    states = [np.tile(one, (CALLS, 1)) for one in (q, rates, efforts)]
    tree = TreeOfPinocchio(mechanism)
    at, qd, tau = tree.state(q, robot.joint_rates(q, rates), efforts)
    model, data = tree.model, tree.data
    # It needs inertia at every joint.
    model.armature = model.armature + 1e-7
    contacts = tree.contacts()
    rooms = pinocchio.StdVec_RigidConstraintData()
    rooms.extend([contact.createData() for contact in contacts])
    pinocchio.initConstraintDynamics(model, data, contacts, rooms)

    def peer() -> None:
        pinocchio.constraintDynamics(model, data, at, qd, tau, contacts, rooms)

    peer()
    found = data.ddq[tree.rates[mechanism.drive_index]]
    assert np.abs(found - robot.forward(q, rates, efforts)).max() < 1e-3
    works = {"ours": Work(lambda: robot.forward(*states), CALLS), "peer": Work(peer, 1)}
    times = interleave(works, rounds=101)
    ours, theirs = times["ours"], times["peer"]
    return [
        _row("inverse dynamics of a hexapod, of a hundred states",
             lambda: robot.inverse(*states), CALLS, INVERSE_LIMIT),
        Row("forward dynamics of a hexapod, of a hundred states", ours.median, peer=theirs.median,
            peer_name="Pinocchio, 36 joints and 5 constraints", spread=ours.spread),
        _row("inverse dynamics of a hexapod, one checked call",
             lambda: robot.inverse(q, rates, efforts), 1),
    ]  # fmt: skip
