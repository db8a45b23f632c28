"""Assembly modes of limbs of any kind: Newton's iteration from many postures, and no proof."""

import numpy as np

from robomech_ros._kernels.loops.searching import search
from robomech_ros.outcomes import Code
from robomech_ros.parallel.mechanism.loops import Loops
from robomech_ros.parallel.mode_order import nearest_order
from robomech_ros.parallel.result import AssemblyModes
from robomech_ros.robots import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, IntArray

_FAMILY = "limbs of any kind, searched"
# Starts in each of so many rounds; it ends when each mode was found so often, and none was new.
_STARTS, _ROUNDS, _OFTEN = 512, 16, 4
# Poses nearer to each other than this (rad; of the size) are one; more of them than so many are a
# motion of the platform while the drives are locked.
_SAME, _MOST = 1e-5, 120
# Error of a loop (rad; of the size), of which half a turn is none.
_CLOSED = 1e-9


class AssemblySearch:
    """A search for all poses of the platform for given drives."""

    def __init__(self, chains: list[SerialChain], loops: Loops) -> None:
        self.loops = loops
        self._slides = np.concatenate([chain.types for chain in chains]) == PRISMATIC
        lower = np.concatenate([chain.lower for chain in chains])
        upper = np.concatenate([chain.upper for chain in chains])
        self._widest = np.where(self._slides, 2.0 * loops.size, np.pi)
        self.lower = np.where(np.isfinite(lower), lower, -self._widest)
        self.upper = np.where(np.isfinite(upper), upper, self._widest)

    def __call__(self, drives: Array, near: Array | None) -> AssemblyModes:
        """Search poses for positions of the drives (m,), those nearest to a pose first."""
        rng = np.random.default_rng(12)
        n = len(self.lower)
        q, starts = np.empty((0, n)), 0
        hits: IntArray = np.empty(0, np.int64)
        for _ in range(_ROUNDS):
            before = len(q)
            q, hits = self._merged(q, hits, self.closed(drives, _STARTS, rng))
            starts += _STARTS
            if len(q) > _MOST or (len(q) == before and len(q) and hits.min() >= _OFTEN):
                break
        return self._found(q, starts, near)

    def closed(self, drives: Array, count: int, rng: np.random.Generator) -> Array:
        """Return postures (k, n) with closed loops, from so many random ones."""
        loops = self.loops
        q = rng.uniform(self.lower, self.upper, (count, len(self.lower)))
        # Half of them without limits: modes beyond those of passive joints are modes, too.
        q[::2] = rng.uniform(-self._widest, self._widest, q[::2].shape)
        q[:, loops.drives >= 0] = drives[loops.drives[loops.drives >= 0]]
        settled = np.empty(count, np.int64)
        search(*loops.chains, loops.weights, q, settled)
        q = q[(settled == 1) & np.isfinite(q).all(axis=1)]
        turns = np.where(self._slides | (loops.drives >= 0), 0.0, np.round(q / (2.0 * np.pi)))
        q = q - 2.0 * np.pi * turns
        poses = loops.limb_poses(q)
        errors = np.abs(poses - poses[:, :1])
        errors[..., :3, 3] /= loops.size
        return np.asarray(q[errors.max(axis=(1, 2, 3), initial=0.0) <= _CLOSED])

    def _merged(self, q: Array, hits: IntArray, new: Array) -> tuple[Array, IntArray]:
        """Add postures whose pose is new; of one pose keep that with joints nearest to limits."""
        kept, counts = list(q), hits.tolist()
        poses = [self._scaled(row) for row in kept]
        for row in new:
            pose = self._scaled(row)
            away = [float(np.abs(pose - other).max()) for other in poses]
            if away and min(away) <= _SAME:
                k = int(np.argmin(away))
                counts[k] += 1
                if self._outside(row) < self._outside(kept[k]):
                    kept[k] = row
                continue
            kept.append(row)
            poses.append(pose)
            counts.append(1)
        return np.array(kept).reshape(-1, len(self.lower)), np.array(counts, np.int64)

    def _scaled(self, q: Array) -> Array:
        pose = self.loops.limb_poses(q)[0].copy()
        pose[:3, 3] /= self.loops.size
        return np.asarray(pose)

    def _outside(self, q: Array) -> float:
        return float(np.maximum(self.lower - q, q - self.upper).max(initial=0.0))

    def _found(self, q: Array, starts: int, near: Array | None) -> AssemblyModes:
        poses = self.loops.limb_poses(q)
        errors = np.abs(poses - poses[:, :1]).max(axis=(1, 2, 3), initial=0.0)
        status = Code.NONE
        reason = f"found from {starts} random postures; nothing proves that these are all"
        if not len(q):
            status = Code.NOT_CONVERGED
            reason = f"no pose found from {starts} random postures; this proves nothing"
        elif len(q) > _MOST:
            status = Code.SINGULAR_CONTINUUM
            reason = f"more than {_MOST} poses: the platform can move while its drives are locked"
        if near is not None and len(q):
            order = nearest_order(poses[:, 0], near, self.loops.size)
            q, poses, errors = q[order], poses[order], errors[order]
        once = np.ones(len(q), np.int64)
        return AssemblyModes(poses[:, 0], once, False, _FAMILY, status, reason, errors, q)
