"""Inverse kinematics against EAIK, ssik, roboticstoolbox and TRAC-IK, as far as they can be had."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import inverse_peers
import numpy as np
from inverse_peers import Array, Peer, available
from table import Row
from timing import Work, interleave

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.iterative import SearchGoal, iterative_data
from robomech_ros.kinematics.inverse.families.iterative_search import iterative_search
from robomech_ros.robots import SerialChain, chain_from_dh, load_robot

ARMS = ("puma560", "ur5e")
POSES = 500
BATCH = 200
CHUNK = 10
SINGLES = 40
REPEATS = 3
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


# A peer that solves fewer poses is told of, but is no measure.
ENOUGH = 0.97


def rows() -> tuple[list[Row], list[str]]:
    """Measure every arm; return the rows of the table and remarks on what each side found."""
    parts = [
        *(_closed_form(name) for name in ARMS),
        *(_general(name) for name in GENERAL_ARMS),
        *_redundant("panda"),
        _short(),
        *(_numeric(name) for name in NUMERIC_ARMS),
    ]
    return [row for table, _ in parts for row in table], [r for _, some in parts for r in some]


def good(chain: SerialChain, target: Array, solutions: Array) -> tuple[int, float]:
    """Count the solutions that reproduce the target; return the count and the largest residual."""
    if not len(solutions):
        return 0, 0.0
    poses = forward_kinematics(chain, np.ascontiguousarray(solutions))
    apart = np.abs(poses - target).max(axis=(1, 2))
    return int((apart < RESIDUAL).sum()), float(apart.max())


def good_of_batch(
    chain: SerialChain, targets: Array, q: Array, count: Array
) -> tuple[Array, float]:
    """Count the good solutions of each target; return them and the largest residual of all."""
    pairs = [
        good(chain, T, rows[:n]) for T, rows, n in zip(targets, q, count.tolist(), strict=True)
    ]
    return np.array([n for n, _ in pairs]), max(worst for _, worst in pairs)


def counts(chain: SerialChain, targets: Array, solve: Callable[[Array], Array]) -> Array:
    """Return how many good solutions each target gets, shape (m,)."""
    return np.array([good(chain, T, solve(T))[0] for T in targets])


def found_by(chain: SerialChain, targets: Array, peer: Peer) -> Array:
    """Return how many good solutions a peer has for each target, shape (m,)."""
    return counts(chain, targets, lambda T: peer.read(peer.call(T)))


def pose_by_pose(calls: Mapping[str, Callable[[Array], Any]], targets: Array) -> dict[str, Array]:
    """Return the microseconds of every call at every target, the least of some repeats."""
    times = {name: np.full(len(targets), np.inf) for name in calls}
    for _ in range(REPEATS):
        for k, T in enumerate(targets):
            for name, call in calls.items():
                begin = time.perf_counter_ns()
                call(T)
                elapsed = (time.perf_counter_ns() - begin) / 1e3
                times[name][k] = min(times[name][k], elapsed)
    return times


def in_chunks(chain: SerialChain, targets: Array, options: dict[str, Any]) -> Array:
    """Return the microseconds a pose of batches of CHUNK poses, the least of some repeats.

    A larger batch would be interrupted on a busy machine.
    """
    calls = {"batch": lambda part: inverse_kinematics_batch(chain, part, **options)}
    parts = targets.reshape(-1, CHUNK, 4, 4)
    return pose_by_pose(calls, parts)["batch"] / CHUNK


def against(
    what: str,
    ours: Array,
    peers: Sequence[Peer],
    times: Mapping[str, Array],
    shares: Array,
    **targets: Any,
) -> Row:
    """Make a row of medians, against the fastest peer that solves nearly all poses."""
    fair = [p.name for p, share in zip(peers, shares, strict=True) if share >= ENOUGH]
    best = min(fair, key=lambda name: float(np.median(times[name])), default="")
    low, median, high = np.quantile(ours, (0.25, 0.5, 0.75))
    peer = float(np.median(times[best])) if best else None
    spread = float((high - low) / 2 / median)
    return Row(what, float(median), peer=peer, peer_name=best, spread=spread, **targets)


def remark(
    what: str,
    mine: Array,
    peers: Sequence[Peer],
    theirs: Sequence[Array],
    times: Mapping[str, Array],
) -> str:
    """Say how many solutions each side finds, and how long each peer takes."""
    parts = [f"{what}: ours {_found(mine)}"]
    parts += [
        f"{peer.name} {_found(count)}, {np.median(times[peer.name]):.0f} us"
        for peer, count in zip(peers, theirs, strict=True)
    ]
    return "; ".join(parts)


def _found(count: Array) -> str:
    return f"{count.mean():.2f} a pose, {(count > 0).mean():.1%} of poses"


def _general_arm(name: str) -> SerialChain:
    if name != "random":
        return load_robot(name)
    rng = np.random.default_rng(0)
    a, b = rng.uniform(0.1, 1.0, 6), rng.uniform(-0.5, 0.5, 6)
    return chain_from_dh(a, b, rng.uniform(-np.pi, np.pi, 6), name=name)


def _general(name: str) -> tuple[list[Row], list[str]]:
    """Time an arm without closed form, pose by pose and in batch."""
    chain = _general_arm(name)
    postures = np.random.default_rng(6).uniform(-np.pi, np.pi, (POSES, chain.n))
    targets = forward_kinematics(chain, postures)
    peers = available(inverse_peers.ssik_general(chain))
    calls = {"ours": lambda T: inverse_kinematics_batch(chain, T[None], respect_limits=False)}
    times = pose_by_pose({**calls, **{peer.name: peer.call for peer in peers}}, targets)
    q, count, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    mine, _ = good_of_batch(chain, targets, q, count)
    theirs = [found_by(chain, targets, peer) for peer in peers]
    batch = in_chunks(chain, targets, {"respect_limits": False})
    arm = f"general 6R ({name})"
    shares = np.array([count.mean() / mine.mean() for count in theirs])
    longest = float(np.quantile(times["ours"], 0.99))
    table = [
        against(f"{arm}, all solutions, batch, a pose", batch, peers, times, shares,
                limit=GENERAL_MEDIAN),
        against(f"{arm}, median pose, one call", times["ours"], peers, times, shares),
        Row(f"{arm}, 99th percentile, one call", longest, limit=GENERAL_LONGEST),
    ]  # fmt: skip
    return table, [remark(arm, mine, peers, theirs, times) + f"; at most {count.max()}"]


def _closed_form(name: str) -> tuple[list[Row], list[str]]:
    """Time an arm with a closed form, call by call and in batch, without joint limits."""
    chain = load_robot(name)
    postures = np.random.default_rng(6).uniform(-np.pi, np.pi, (POSES, chain.n))
    targets = forward_kinematics(chain, postures)
    peers = available(inverse_peers.eaik(chain))
    q, count, _ = inverse_kinematics_batch(chain, targets, respect_limits=False)
    mine, worst = good_of_batch(chain, targets, q, count)
    text = f"{name}: ours {_found(mine)}, worst residual {worst:.1e}"
    for peer in peers:
        theirs = found_by(chain, targets, peer)
        text += f"; {peer.name} {_found(theirs)}, {(mine != theirs).sum()} poses differ"
    return _time(name, chain, peers, targets), [text]


def _time(name: str, chain: SerialChain, peers: Sequence[Peer], targets: Array) -> list[Row]:
    batch = targets[:BATCH]
    ordered = [np.asfortranarray(target) for target in batch]  # what EAIK takes without a copy
    works = {
        "public": Work(
            lambda: [inverse_kinematics(chain, T, respect_limits=False) for T in batch[:SINGLES]],
            SINGLES,
        ),
        "batch": Work(lambda: inverse_kinematics_batch(chain, batch, respect_limits=False), BATCH),
        "limits": Work(lambda: inverse_kinematics_batch(chain, batch), BATCH),
    }
    for peer in peers:
        works[peer.name] = Work(lambda p=peer: [p.call(T) for T in ordered[:SINGLES]], SINGLES)
        if peer.batch is not None:
            works[f"{peer.name} batch"] = Work(lambda p=peer: p.batch(ordered), BATCH)
    times = interleave(works)
    single, many, limits = times["public"], times["batch"], times["limits"]
    # The peer's batch starts a worker thread, and may be slower than its single calls.
    best = {
        peer.name: min(times[key].median for key in times if key.startswith(peer.name))
        for peer in peers
    }
    of = {"peer_name": peers[0].name if peers else ""}
    alone = times[of["peer_name"]].median if peers else None
    at_best = best[of["peer_name"]] if peers else None
    return [
        Row(f"{name}, all solutions, one public call", single.median, peer=alone,
            spread=single.spread, limit=SINGLE_LIMIT, **of),
        Row(f"{name}, all solutions, batch, a pose", many.median, peer=at_best,
            spread=many.spread, ratio_limit=BATCH_RATIO, **of),
        Row(f"{name}, batch with limits, a pose", limits.median, peer=at_best,
            spread=limits.spread, **of),
    ]  # fmt: skip


def _postures(chain: SerialChain, count: int) -> Array:
    """Draw random postures inside the limits, angles within half a turn."""
    half = np.where(chain.types == 1, 0.5, np.pi)
    lower, upper = np.maximum(chain.lower, -half), np.minimum(chain.upper, half)
    return np.random.default_rng(6).uniform(lower, upper, (count, chain.n))


def _redundant(name: str) -> list[tuple[list[Row], list[str]]]:
    """Time the sampled family of a redundant arm, and the nearest solution to a seed near by."""
    chain = load_robot(name)
    postures = _postures(chain, BATCH)
    targets = forward_kinematics(chain, postures)
    near = postures[0]
    poses = forward_kinematics(
        chain, np.clip(near + 0.1 * np.sin(postures), chain.lower, chain.upper)
    )
    everything = available(inverse_peers.ssik_panda(chain))
    one = available(
        inverse_peers.ssik_panda(chain, near),
        inverse_peers.toolbox(chain, near),
        inverse_peers.trac_ik(chain, near, poses),
    )
    return [
        _sampled(f"{name}, sampled family, batch, a pose", chain, targets, everything,
                 {"respect_limits": False}, FAMILY_LIMIT),
        _sampled(f"{name}, nearest solution, batch, a pose", chain, poses, one,
                 {"seed": near, "max_solutions": 1}, NEAREST_LIMIT),
    ]  # fmt: skip


def _sampled(
    what: str,
    chain: SerialChain,
    targets: Array,
    peers: Sequence[Peer],
    options: dict[str, Any],
    limit: float,
) -> tuple[list[Row], list[str]]:
    """Time our batch against the single calls of the peers."""
    batch = in_chunks(chain, targets, options)
    q, count, _ = inverse_kinematics_batch(chain, targets, **options)
    mine, _ = good_of_batch(chain, targets, q, count)
    theirs = [found_by(chain, targets, peer) for peer in peers]
    times = pose_by_pose({peer.name: peer.call for peer in peers}, targets)
    shares = np.array([(count > 0).mean() for count in theirs])
    row = against(what, batch, peers, times, shares, limit=limit)
    return [row], [remark(what, mine, peers, theirs, times)]


def _short() -> tuple[list[Row], list[str]]:
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
    return table, []


def _numeric(name: str) -> tuple[list[Row], list[str]]:
    """Time the iterative solver to its first solution, pose by pose, for an arm of six joints."""
    chain = load_robot(name)
    data, seed = iterative_data(chain, SearchGoal(wanted=1)), chain.midrange()
    targets = forward_kinematics(chain, _postures(chain, POSES))
    peers = available(
        inverse_peers.toolbox(chain, seed), inverse_peers.trac_ik(chain, seed, targets)
    )

    def ours(T: Array) -> Any:
        return iterative_search(data, T, seed)

    times = pose_by_pose({"ours": ours, **{peer.name: peer.call for peer in peers}}, targets)
    mine = counts(chain, targets, lambda T: ours(T).q)
    theirs = [found_by(chain, targets, peer) for peer in peers]
    shares = np.array([(count > 0).mean() for count in theirs])
    what = f"{name}, iterative, one solution, {(mine > 0).mean():.1%} of poses"
    row = against(what, times["ours"], peers, times, shares, limit=NUMERIC_LIMIT)
    return [row], [remark(f"{name}, iterative", mine, peers, theirs, times)]
