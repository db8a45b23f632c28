"""Derivatives of the Jacobian and the condition number with gradient, against Pinocchio; reports.

Pinocchio's equivalent of the derivative is that of the Jacobian at the tip.  It has no condition
number: its equivalent is its Jacobian and its kinematic Hessian at the tip, with numpy's singular
values in between, which is what its users write.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio
from peers import Array, pinocchio_model
from table import Row
from timing import Timing, Work, interleave

from robomech_ros._kernels.chain import jacobian_rates
from robomech_ros._kernels.kinetostatics import indices
from robomech_ros.kinetostatics import (
    characteristic_length,
    condition_number_gradient,
    jacobian,
    jacobian_rate,
    singularity_free,
    singularity_report,
)
from robomech_ros.robots import SerialChain, load_robot

BATCH = 200
SINGLES = 20
AGREEMENT = 1e-9
KERNEL_RATIO = 1.0
PUBLIC_LIMIT = 2.0
BATCH_RATIO = 0.5
REPORT_LIMIT = 30.0
PINOCCHIO = "Pinocchio"


def rows() -> list[Row]:
    """Measure on the PUMA 560 and the Panda and return the rows of the table."""
    found = []
    for name in ("puma560", "panda"):
        chain = load_robot(name)
        postures = np.random.default_rng(5).uniform(-2.0, 2.0, (2, BATCH, chain.n))
        length = float(characteristic_length(chain))
        found += _rates(chain, *postures)
        found += _gradients(chain, postures[0], length)
        found += _reports(chain, postures[0], length)
    return found


def _rates(chain: SerialChain, q: Array, qd: Array) -> list[Row]:
    """Time the derivative of the Jacobian in time."""
    model, data, tip = pinocchio_model(chain)
    axes = pinocchio.LOCAL_WORLD_ALIGNED
    singles = list(zip(q[:SINGLES], qd[:SINGLES], strict=True))
    packed, out = chain.packed, np.empty((6, chain.n))

    def kernel() -> Array:
        for one, rate in singles:
            jacobian_rates.jacobian_rate_one(packed, one, rate, out)
        return out

    def public() -> Array:
        for one, rate in singles:
            result = jacobian_rate(chain, one, rate)
        return result

    def peer() -> Array:
        for one, rate in singles:
            pinocchio.computeJointJacobiansTimeVariation(model, data, one, rate)
            result = pinocchio.getFrameJacobianTimeVariation(model, data, tip, axes)
        return np.vstack([result[3:], result[:3]])

    what = f"time derivative of the Jacobian, {chain.name}"
    return _compared(what, kernel, public, peer, lambda: jacobian_rate(chain, q, qd))


def _gradients(chain: SerialChain, q: Array, length: float) -> list[Row]:
    """Time the condition number with its gradient, lengths over the characteristic length."""
    model, data, tip = pinocchio_model(chain)
    singles, packed, n = list(q[:SINGLES]), chain.packed, chain.n
    weights, every = np.repeat((1.0, 1.0 / length), 3), np.arange(6)
    linear_first = np.repeat((1.0 / length, 1.0), 3)
    out = np.empty(n)
    given = (weights, every, 2.0, indices.CONDITION)
    joint, offset = model.frames[tip].parentJoint, model.frames[tip].placement
    to_tip = linear_first[:, None] * offset.toActionMatrixInverse()

    def kernel() -> Array:
        for one in singles:
            indices.index_gradient_one(packed, one, *given, out)
        return out

    def public() -> Array:
        for one in singles:
            result = condition_number_gradient(chain, one, length=length)
        return result

    def peer() -> Array:
        for one in singles:
            pinocchio.computeJointJacobians(model, data, one)
            pinocchio.computeJointKinematicHessians(model, data)
            pinocchio.updateFramePlacement(model, data, tip)
            # In axes of the tip, which leaves the singular values as they are.
            J = pinocchio.getFrameJacobian(model, data, tip, pinocchio.LOCAL)
            left, s, right = np.linalg.svd(linear_first[:, None] * J, full_matrices=False)
            H = pinocchio.getJointKinematicHessian(model, data, joint, pinocchio.LOCAL)
            # Its entries stand in the order of columns.
            H = H.reshape(n, n, 6)
            most, least = (H @ (left[:, k] @ to_tip) @ right[k] for k in (0, -1))
            result = most / s[-1] - s[0] / s[-1] ** 2 * least
        return result

    what = f"condition number with gradient, {chain.name}"

    def batch() -> Array:
        return condition_number_gradient(chain, q, length=length)

    return _compared(what, kernel, public, peer, batch)


def _compared(
    what: str,
    kernel: Callable[[], Array],
    public: Callable[[], Array],
    peer: Callable[[], Array],
    batch: Callable[[], object],
) -> list[Row]:
    """Time ours and the peer's in turn; return a row for each of ours."""
    ours, theirs = kernel(), peer()
    difference = float(np.abs(ours - theirs).max() / max(1.0, float(np.abs(theirs).max())))
    if difference > AGREEMENT:
        raise SystemExit(f"{what}: ours and Pinocchio's differ by {difference:.1e}")
    singles = {"kernel": kernel, "public": public, "peer": peer}
    works = {key: Work(call, SINGLES) for key, call in singles.items()}
    times = interleave({**works, "batch": Work(batch, BATCH)})
    peer_time, kernel_time = times["peer"].median, times["kernel"].median

    def row(name: str, timing: Timing, **target: float) -> Row:
        figures = {"peer": peer_time, "peer_name": PINOCCHIO, "spread": timing.spread}
        return Row(f"{what}, {name}", timing.median, **figures, **target)

    return [
        row("kernel from Python", times["kernel"], ratio_limit=KERNEL_RATIO),
        row("public function", times["public"], limit=kernel_time + PUBLIC_LIMIT),
        row("batch, a state", times["batch"], ratio_limit=BATCH_RATIO),
    ]


def _reports(chain: SerialChain, q: Array, length: float) -> list[Row]:
    """Time the singularity report, regular and singular, and a proof that there is room."""
    singular, regular = np.zeros(chain.n), list(q[:SINGLES])
    room = np.full(chain.n, 0.05)
    middle = q[int(np.argmax(np.abs(np.linalg.svd(jacobian(chain, q), compute_uv=False)[:, 5])))]

    def reports() -> None:
        for one in regular:
            singularity_report(chain, one, length=length)

    def at_singularity() -> None:
        for _ in range(SINGLES):
            singularity_report(chain, singular, length=length)

    def proof() -> None:
        if not singularity_free(chain, middle - room, middle + room).proven:
            raise SystemExit(f"{chain.name}: no proof of the room about a regular posture")

    times = interleave(
        {
            "regular": Work(reports, SINGLES),
            "singular": Work(at_singularity, SINGLES),
            "proof": Work(proof, 1),
        }
    )
    what = f"singularity report, {chain.name}"
    return [
        Row(what, times["regular"].median, spread=times["regular"].spread, limit=REPORT_LIMIT),
        Row(
            f"{what}, where singular",
            times["singular"].median,
            spread=times["singular"].spread,
            limit=REPORT_LIMIT,
        ),
        Row(
            f"proof that +-0.05 rad hold no singular posture, {chain.name}",
            times["proof"].median,
            spread=times["proof"].spread,
        ),
    ]
