"""Rotations, poses and points against scipy, Pinocchio, pytransform3d and jaxlie.

Single calls are those of the public functions, which check what they are given.  Times are those of
the processor.  A peer that is not installed is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.util import find_spec
from time import process_time_ns
from typing import Any

import numpy as np
import pinocchio
from scipy.spatial.transform import Rotation, Slerp
from table import Row
from timing import Work, interleave

from robomech_ros import spatial

BATCH = 10_000
SINGLES = 50
SINGLE_LIMIT = 5.0
POINTS_LIMIT = 10.0
BATCH_LIMITS = {"exponential": 0.03, "logarithm": 0.06, "pose logarithm": 0.15, "slerp": 0.04}
AGREEMENT = 1e-9

Calls = Mapping[str, Callable[[], Any]]


def rows() -> list[Row]:
    """Measure and return the rows of the table."""
    rng = np.random.default_rng(3)
    vectors = rng.normal(size=(BATCH, 3))
    screws = np.concatenate((vectors, rng.normal(size=(BATCH, 3))), axis=-1)
    ours = {
        "exponential": (spatial.matrix_from_rotation_vector, vectors),
        "logarithm": (
            spatial.rotation_vector_from_matrix,
            spatial.matrix_from_rotation_vector(vectors),
        ),
        "pose logarithm": (spatial.pose_logarithm, spatial.pose_exponential(screws)),
    }
    peers = _batch_peers(ours["logarithm"][1], vectors, ours["pose logarithm"][1])
    found = []
    for what, (function, given) in ours.items():
        found += _single(what, function, list(given[:SINGLES]))
        calls = {"ours": lambda f=function, g=given: f(g)}
        found += _batch(what, calls | peers[what])
    found += _single("adjoint", spatial.pose_adjoint, list(ours["pose logarithm"][1][:SINGLES]))
    return [*found, *_slerp(), _points(rng)]


def _single(what: str, function: Callable[[Any], Any], given: list[Any]) -> list[Row]:
    """Time one call after the other, and Pinocchio's on the same."""
    theirs = {
        "exponential": pinocchio.exp3,
        "logarithm": pinocchio.log3,
        "pose logarithm": lambda T: pinocchio.log6(pinocchio.SE3(T)).vector,
        "adjoint": lambda T: pinocchio.SE3(T).toActionMatrix(),
    }[what]

    def run(call: Callable[[Any], Any]) -> Callable[[], None]:
        def work() -> None:
            for one in given:
                call(one)

        return work

    works = {"ours": Work(run(function), SINGLES), "peer": Work(run(theirs), SINGLES)}
    times = interleave(works, clock=process_time_ns)
    return [
        Row(
            f"{what}, one checked call",
            times["ours"].median,
            peer=times["peer"].median,
            peer_name="Pinocchio, unchecked",
            spread=times["ours"].spread,
            limit=SINGLE_LIMIT,
        )
    ]


def _batch(what: str, calls: Calls, read: Mapping[str, Callable[[Any], Any]] = {}) -> list[Row]:
    """Time a batch against each peer; the row has the fastest.

    What a peer writes in another order is read before it is compared, not while it is timed.
    """
    results = {name: np.asarray(read.get(name, np.asarray)(call())) for name, call in calls.items()}
    for name, result in results.items():
        difference = float(np.abs(result - results["ours"]).max())
        if difference > AGREEMENT:
            raise SystemExit(f"{what}: ours and {name} differ by {difference:.1e}")
    works = {name: Work(call, BATCH) for name, call in calls.items()}
    times = interleave(works, rounds=41, clock=process_time_ns)
    peers = {name: timing.median for name, timing in times.items() if name != "ours"}
    best = min(peers, key=lambda name: peers[name])
    return [
        Row(
            f"{what}, a batch of {BATCH}, each",
            times["ours"].median,
            peer=peers[best],
            peer_name=best,
            spread=times["ours"].spread,
            limit=BATCH_LIMITS[what],
            ratio_limit=1.0,
        )
    ]


def _batch_peers(matrices: Any, vectors: Any, poses: Any) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {
        "exponential": {"scipy": lambda: Rotation.from_rotvec(vectors).as_matrix()},
        "logarithm": {"scipy": lambda: Rotation.from_matrix(matrices).as_rotvec()},
        "pose logarithm": {},
    }
    if find_spec("pytransform3d"):
        from pytransform3d import batch_rotations, trajectories

        found["exponential"]["pytransform3d"] = lambda: (
            batch_rotations.matrices_from_compact_axis_angles(vectors)
        )
        found["pose logarithm"]["pytransform3d"] = lambda: (
            trajectories.exponential_coordinates_from_transforms(poses)
        )
    if find_spec("jaxlie"):
        found = _with_jaxlie(found, matrices, vectors, poses)
    if not found["pose logarithm"]:
        from scipy.spatial.transform import RigidTransform

        transforms = RigidTransform.from_matrix(poses)
        found["pose logarithm"]["scipy"] = transforms.as_exp_coords
    return found


def _with_jaxlie(
    found: dict[str, dict[str, Any]], matrices: Any, vectors: Any, poses: Any
) -> dict[str, dict[str, Any]]:
    import jax

    jax.config.update("jax_enable_x64", True)
    import jaxlie

    exponential = jax.jit(jax.vmap(lambda v: jaxlie.SO3.exp(v).as_matrix()))
    logarithm = jax.jit(jax.vmap(lambda m: jaxlie.SO3.from_matrix(m).log()))

    def angular_first(T: Any) -> Any:
        xi = jaxlie.SE3.from_matrix(T).log()
        return jax.numpy.concatenate((xi[3:], xi[:3]))

    screw = jax.jit(jax.vmap(angular_first))
    found["exponential"]["jaxlie"] = lambda: exponential(vectors).block_until_ready()
    found["logarithm"]["jaxlie"] = lambda: logarithm(matrices).block_until_ready()
    found["pose logarithm"]["jaxlie"] = lambda: screw(poses).block_until_ready()
    return found


def _slerp() -> list[Row]:
    ends = Rotation.random(2, rng=np.random.default_rng(4))
    start, goal = ends.as_quat()
    fractions = np.linspace(0.0, 1.0, BATCH)
    path = Slerp([0, 1], ends)
    calls = {
        "ours": lambda: spatial.slerp(start, goal, fractions),
        "scipy": lambda: path(fractions).as_quat(canonical=True),
    }
    read = {}
    if find_spec("pytransform3d"):
        from pytransform3d.batch_rotations import quaternion_slerp_batch

        scalar_first = np.roll(start, 1), np.roll(goal, 1)
        calls["pytransform3d"] = lambda: quaternion_slerp_batch(*scalar_first, fractions, True)
        read["pytransform3d"] = lambda q: np.roll(np.where(q[:, :1] < 0.0, -q, q), -1, axis=1)
    return _batch("slerp", calls, read)


def _points(rng: np.random.Generator) -> Row:
    """Angular velocities of four points, a sample at a time, as they come from a camera."""
    points = 0.1 * rng.normal(size=(SINGLES, 4, 3))
    velocities = np.cross([0.5, -1.0, 0.3], points)
    samples = list(zip(points, velocities, strict=True))

    def work() -> None:
        for sample in samples:
            spatial.angular_velocity_from_points(*sample)

    timing = interleave({"ours": Work(work, SINGLES)}, clock=process_time_ns)["ours"]
    return Row(
        "angular velocity of four points, a sample",
        timing.median,
        spread=timing.spread,
        limit=POINTS_LIMIT,
    )
