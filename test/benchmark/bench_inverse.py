"""Inverse kinematics: PUMA 560 and UR5e against EAIK; general, redundant and short arms alone."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from eaik.IK_Homogeneous import HomogeneousRobot
from peers import Array, eaik_robot
from table import Row
from timing import Timing, Work, interleave, summarise

from robomech_ros.kinematics import (
    forward_kinematics,
    inverse_kinematics,
    inverse_kinematics_batch,
)
from robomech_ros.kinematics.iterative import iterative_data, iterative_search
from robomech_ros.robots import SerialChain, chain_from_dh, load_robot

ARMS = ("puma560", "ur5e")
POSES = 500
BATCH = 200
SHORT_BATCH = 20
SINGLES = 10
REPEATS = 5
RESIDUAL = 1e-6
SINGLE_LIMIT = 10.0
FAMILY_LIMIT = 60.0
NEAREST_LIMIT = 15.0
NUMERIC_LIMIT = 50.0
NUMERIC_ARMS = ("puma560", "ur5e", "general6r")
SHORT_ARMS = ("planar3r", "scara", "vx300")
BATCH_RATIO = 0.5
# Arms that EAIK refuses: one of random numbers, and one with up to 16 solutions.
GENERAL_ARMS = ("random", "general6r")
GENERAL_MEDIAN = 80.0
GENERAL_LONGEST = 200.0  # at the 99th percentile


@dataclass(frozen=True)
class Counts:
    """How many solutions each side found whose pose is within RESIDUAL of the target.

    Attributes
    ----------
    ours, peer : int
        Good solutions over all poses.
    differing : int
        Poses for which the two sides differ in number.
    worst : float
        The largest residual among our solutions (m, and rad by matrix entries).
    """

    ours: int
    peer: int
    differing: int
    worst: float


def rows() -> tuple[list[Row], list[str]]:
    """Measure every arm; return the rows of the table and a remark on each arm's counts."""
    table: list[Row] = []
    remarks: list[str] = []
    for name in ARMS:
        chain = load_robot(name)
        postures = np.random.default_rng(6).uniform(-np.pi, np.pi, (POSES, chain.n))
        targets = forward_kinematics(chain, postures)
        peer = eaik_robot(chain)
        counts = count_solutions(chain, peer, targets)
        remarks.append(
            f"{name}: {counts.ours / POSES:.2f} solutions a pose, EAIK {counts.peer / POSES:.2f}, "
            f"{counts.differing} of {POSES} poses differ, our worst residual {counts.worst:.1e}"
        )
        table += _time(name, chain, peer, targets)
    for name in GENERAL_ARMS:
        rows_of_arm, remark = _time_general(name)
        table += rows_of_arm
        remarks.append(remark)
    panda, remark = _redundant("panda")
    return table + panda + _short() + _numeric(), [*remarks, remark]


def _general_arm(name: str) -> SerialChain:
    if name != "random":
        return load_robot(name)
    rng = np.random.default_rng(0)
    a, b = rng.uniform(0.1, 1.0, 6), rng.uniform(-0.5, 0.5, 6)
    return chain_from_dh(a, b, rng.uniform(-np.pi, np.pi, 6))


def _time_general(name: str) -> tuple[list[Row], str]:
    """Time an arm without closed form, pose by pose inside the compiled loop and in batch."""
    chain = _general_arm(name)
    postures = np.random.default_rng(6).uniform(-np.pi, np.pi, (POSES, chain.n))
    targets = forward_kinematics(chain, postures)
    _, count, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    single = np.full(POSES, np.inf)
    for _ in range(REPEATS):
        for k in range(POSES):
            one = targets[k : k + 1]
            start = time.perf_counter()
            inverse_kinematics_batch(chain, one, respect_limits=False)
            single[k] = min(single[k], time.perf_counter() - start)
    times = interleave(
        {
            "batch": Work(
                lambda: inverse_kinematics_batch(chain, targets, respect_limits=False), POSES
            )
        }
    )
    batch = times["batch"]
    longest = 1e6 * float(np.quantile(single, 0.99))
    median = 1e6 * float(np.median(single))
    table = [
        Row(f"general 6R ({name}), all solutions, batch, a pose", batch.median,
            spread=batch.spread, limit=GENERAL_MEDIAN),
        Row(f"general 6R ({name}), median pose, one call", median),
        Row(f"general 6R ({name}), 99th percentile, one call", longest, limit=GENERAL_LONGEST),
    ]  # fmt: skip
    return table, f"general 6R ({name}): {count.mean():.2f} solutions a pose, at most {count.max()}"


def count_solutions(chain: SerialChain, peer: HomogeneousRobot, targets: Array) -> Counts:
    """Count on both sides the solutions that reproduce their target."""
    q, count, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    ours = theirs = differing = 0
    worst = 0.0
    for index, target in enumerate(targets):
        mine = _residuals(chain, target, q[index, : count[index]])
        other = _residuals(chain, target, np.asarray(peer.IK(target).Q).reshape(-1, chain.n))
        good, peer_good = int((mine < RESIDUAL).sum()), int((other < RESIDUAL).sum())
        ours, theirs = ours + good, theirs + peer_good
        differing += good != peer_good
        worst = max(worst, float(mine.max(initial=0.0)))
    return Counts(ours, theirs, differing, worst)


def _residuals(chain: SerialChain, target: Array, solutions: Array) -> Array:
    """Return the largest entry of pose minus target for each solution."""
    if not len(solutions):
        return np.empty(0)
    poses = forward_kinematics(chain, np.ascontiguousarray(solutions))
    return np.abs(poses - target).max(axis=(1, 2))


def _time(name: str, chain: SerialChain, peer: HomogeneousRobot, targets: Array) -> list[Row]:
    """Time one arm, call by call and in batch, both sides without joint limits."""
    batch = targets[:BATCH]
    ordered = [np.asfortranarray(target) for target in batch]  # what EAIK takes without a copy
    singles, peer_singles = list(batch[:SINGLES]), ordered[:SINGLES]

    def run_public() -> None:
        for target in singles:
            inverse_kinematics(chain, target, respect_limits=False)

    def run_peer() -> None:
        for target in peer_singles:
            peer.IK(target)

    times = interleave(
        {
            "public": Work(run_public, SINGLES),
            "peer": Work(run_peer, SINGLES),
            "batch": Work(
                lambda: inverse_kinematics_batch(chain, batch, respect_limits=False), BATCH
            ),
            "limits": Work(lambda: inverse_kinematics_batch(chain, batch), BATCH),
            "peer batch": Work(lambda: peer.IK_batched(ordered, 1), BATCH),
        }
    )
    single, many, limits = times["public"], times["batch"], times["limits"]
    peer_single = times["peer"].median
    peer_best = min(peer_single, times["peer batch"].median)  # its batch starts a worker thread
    return [
        Row(f"{name}, all solutions, one public call", single.median, peer=peer_single,
            peer_name="EAIK", spread=single.spread, limit=SINGLE_LIMIT),
        Row(f"{name}, all solutions, batch, a pose", many.median, peer=peer_best,
            peer_name="EAIK", spread=many.spread, ratio_limit=BATCH_RATIO),
        Row(f"{name}, batch with limits, a pose", limits.median, peer=peer_best,
            peer_name="EAIK", spread=limits.spread),
    ]  # fmt: skip


def _postures(chain: SerialChain, count: int) -> Array:
    """Draw random postures inside the limits, angles within half a turn."""
    half = np.where(chain.types == 1, 0.5, np.pi)
    lower, upper = np.maximum(chain.lower, -half), np.minimum(chain.upper, half)
    return np.random.default_rng(6).uniform(lower, upper, (count, chain.n))


def _redundant(name: str) -> tuple[list[Row], str]:
    """Time the sampled family of a redundant arm, and the nearest solution to a seed near by."""
    chain = load_robot(name)
    postures = _postures(chain, BATCH)
    targets = forward_kinematics(chain, postures)
    near = postures[0]
    poses = forward_kinematics(
        chain, np.clip(near + 0.1 * np.sin(postures), chain.lower, chain.upper)
    )
    works = {}
    for k in range(0, BATCH, SHORT_BATCH):
        some, others = targets[k : k + SHORT_BATCH], poses[k : k + SHORT_BATCH]
        works[f"family {k}"] = Work(
            lambda T=some: inverse_kinematics_batch(chain, T, respect_limits=False), SHORT_BATCH
        )
        works[f"nearest {k}"] = Work(
            lambda T=others: inverse_kinematics_batch(chain, T, seed=near, max_solutions=1),
            SHORT_BATCH,
        )
    times = interleave(works, rounds=101)
    _, count, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    family, nearest = _mean(times, "family"), _mean(times, "nearest")
    remark = f"{name}: {count.mean():.1f} solutions a pose, {count.min()} at least"
    return [
        Row(f"{name}, sampled family, batch, a pose", family.median, spread=family.spread,
            limit=FAMILY_LIMIT),
        Row(f"{name}, nearest solution, batch, a pose", nearest.median, spread=nearest.spread,
            limit=NEAREST_LIMIT),
    ], remark  # fmt: skip


def _mean(times: Mapping[str, Timing], kind: str) -> Timing:
    """Average the parts of a batch that is too long to be timed at once."""
    parts = [timing for name, timing in times.items() if name.startswith(kind)]
    return Timing(
        sum(part.median for part in parts) / len(parts),
        sum(part.spread for part in parts) / len(parts),
    )


def _short() -> list[Row]:
    """Time all solutions of arms with fewer than six joints."""
    table = []
    for name in SHORT_ARMS:
        chain = load_robot(name)
        targets = forward_kinematics(chain, _postures(chain, BATCH))
        work = Work(lambda c=chain, T=targets: inverse_kinematics_batch(c, T), BATCH)
        timing = interleave({name: work})[name]
        table.append(
            Row(f"{name}, all solutions, batch, a pose", timing.median, spread=timing.spread)
        )
    return table


def _numeric() -> list[Row]:
    """Time the iterative solver to its first solution, pose by pose, for arms of six joints."""
    table = []
    for name in NUMERIC_ARMS:
        chain = load_robot(name)
        data, seed = iterative_data(chain, wanted=1), chain.midrange()
        targets = forward_kinematics(chain, _postures(chain, POSES))
        samples, solved = [], 0
        for target in targets:
            begin = time.perf_counter_ns()
            search = iterative_search(data, target, seed)
            samples.append((time.perf_counter_ns() - begin) / 1e3)
            solved += len(search.q) > 0
        timing = summarise(samples)
        table.append(
            Row(f"{name}, iterative, one solution, {solved / POSES:.1%} of poses", timing.median,
                spread=timing.spread, limit=NUMERIC_LIMIT)
        )  # fmt: skip
    return table
