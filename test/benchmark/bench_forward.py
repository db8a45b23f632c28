"""Forward kinematics and the Jacobian of a six-joint arm, against Pinocchio.

Pinocchio is timed twice: by the calls that return what ours returns, the pose of the tip or the
Jacobian at the tip, which is what the target means, and by the bare call, which leaves the pose
inside the library or gives the Jacobian at another point.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio
from peers import Array, pinocchio_model
from table import Row
from timing import Work, interleave

from robomech_ros._kernels.chain import serial
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot

BATCH = 1000
SINGLES = 100
AGREEMENT = 1e-12
KERNEL_RATIO = 1.0
PUBLIC_LIMIT = 2.0
BATCH_LIMIT = 0.25


def rows() -> list[Row]:
    """Measure on the PUMA 560 and return the rows of the table."""
    chain = load_robot("puma560")
    postures = np.random.default_rng(560).uniform(-np.pi, np.pi, (BATCH, chain.n))
    singles = list(postures[:SINGLES])
    packed = chain.packed
    model, data, tip = pinocchio_model(chain)
    axes = pinocchio.LOCAL_WORLD_ALIGNED
    pose, matrix = np.empty((4, 4)), np.empty((6, chain.n))

    def forward_kernel() -> None:
        for q in singles:
            serial.forward_one(packed, q, pose)

    def forward_public() -> None:
        for q in singles:
            forward_kinematics(chain, q)

    def forward_call() -> None:
        for q in singles:
            pinocchio.forwardKinematics(model, data, q)

    def forward_result() -> Array:
        for q in singles:
            pinocchio.forwardKinematics(model, data, q)
            result = pinocchio.updateFramePlacement(model, data, tip).homogeneous
        return result

    def jacobian_kernel() -> None:
        for q in singles:
            serial.jacobian_one(packed, q, matrix, pose)

    def jacobian_public() -> None:
        for q in singles:
            jacobian(chain, q)

    def jacobian_call() -> None:
        for q in singles:
            pinocchio.computeJointJacobians(model, data, q)

    def jacobian_result() -> Array:
        for q in singles:
            result = pinocchio.computeFrameJacobian(model, data, q, tip, axes)
        return np.vstack([result[3:], result[:3]])  # ours has the angular rows first

    forward_kernel()
    jacobian_kernel()
    _agree("pose", pose, forward_result())
    _agree("Jacobian", matrix, jacobian_result())
    return [
        *_compare(
            "forward kinematics",
            lambda: forward_kinematics(chain, postures),
            kernel=forward_kernel,
            public=forward_public,
            call=forward_call,
            result=forward_result,
        ),
        *_compare(
            "Jacobian",
            lambda: jacobian(chain, postures),
            kernel=jacobian_kernel,
            public=jacobian_public,
            call=jacobian_call,
            result=jacobian_result,
        ),
    ]


def _agree(what: str, ours: Array, peer: Array) -> None:
    """Stop where the two sides do not compute the same."""
    difference = float(np.abs(ours - peer).max())
    if difference > AGREEMENT:
        raise SystemExit(f"{what}: ours and Pinocchio's differ by {difference:.1e}")


def _compare(name: str, batch: Callable[[], object], **singles: Callable[[], object]) -> list[Row]:
    """Time the batch, and `singles` over SINGLES postures each; return a row for each of ours."""
    works = {key: Work(call, SINGLES) for key, call in singles.items()}
    times = interleave({**works, "batch": Work(batch, BATCH)})
    result, call = times["result"].median, times["call"].median

    def row(what: str, key: str, peer: float, peer_name: str, **target: float) -> Row:
        timing = times[key]
        return Row(
            f"{name}, {what}",
            timing.median,
            peer=peer,
            peer_name=peer_name,
            spread=timing.spread,
            **target,
        )

    bare, full = "Pinocchio, bare call", "Pinocchio, result read"
    return [
        row("kernel from Python", "kernel", result, full, ratio_limit=KERNEL_RATIO),
        row("kernel from Python", "kernel", call, bare),
        row("public function", "public", result, full, limit=PUBLIC_LIMIT),
        row("batch, a pose", "batch", result, full, limit=BATCH_LIMIT),
    ]
