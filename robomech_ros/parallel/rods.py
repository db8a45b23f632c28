"""Six limbs that end in a rod from a universal to a spherical joint: a platform on six legs.

Whatever drives move in front of the universal joint or within the rod, for given drives the
distances of six points of the base from six of the platform are known: all poses are found as those
of :class:`StewartGough`, with its certificate.
"""

from dataclasses import dataclass

import numpy as np

from robomech_ros.parallel.mechanism.limb import Limb
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.result import DirectKinematicsResult
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.robots import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, joint_transform
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

# How far from each other axes pass that meet (m, of the size), and the least sine between them.
_MEET, _ACROSS = 1e-9, 1e-6
_LEGS = 6


@dataclass(frozen=True, eq=False)
class SixRods:
    """All poses of a platform on six rods; a foot is the first joint of a universal one."""

    limbs: tuple[Limb, ...]
    feet: tuple[int, ...]

    def __call__(self, drives: Array, near: Array | None) -> DirectKinematicsResult:
        """Find them for positions of the drives (m,), those nearest to a pose first."""
        on_base, on_platform = np.empty((_LEGS, 3)), np.empty((_LEGS, 3))
        lengths, first = np.empty(_LEGS), 0
        for k, (limb, foot) in enumerate(zip(self.limbs, self.feet, strict=True)):
            chain, count = limb.chain, len(limb.actuated)
            q = np.zeros(chain.n)
            q[[name in limb.actuated for name in chain.joint_names]] = drives[first : first + count]
            first += count
            frames = _frames(chain, q)
            on_base[k], _ = _meeting(frames[foot], frames[foot + 1])
            ball, _ = _meeting(frames[-4], frames[-3])
            on_platform[k] = (rigid_inverse(frames[-1]) @ [*ball, 1.0])[:3]
            lengths[k] = np.linalg.norm(ball - on_base[k])
        return StewartGough(on_base, on_platform).direct(lengths, near)


def six_rods(mechanism: Mechanism) -> SixRods | None:
    """Return what solves a mechanism as a platform on six legs, if its six limbs end in rods."""
    feet = [_foot(limb, mechanism.size) for limb in mechanism.limbs]
    found = tuple(foot for foot in feet if foot is not None)
    if len(mechanism.limbs) != _LEGS or len(found) != _LEGS:
        return None
    return SixRods(mechanism.limbs, found)


def _foot(limb: Limb, size: float) -> int | None:
    """Find the universal joint of a limb whose other passive joints are a spherical one."""
    chain = limb.chain
    passive = [k for k, name in enumerate(chain.joint_names) if name not in limb.actuated]
    if len(passive) != 5 or passive[2:] != list(range(chain.n - 3, chain.n)):
        return None
    if passive[1] != passive[0] + 1 or (chain.types[passive] == PRISMATIC).any():
        return None
    frames = _frames(chain, np.zeros(chain.n))
    pairs = [(passive[0], passive[1]), (chain.n - 3, chain.n - 2), (chain.n - 2, chain.n - 1)]
    met = [_meeting(frames[i], frames[j]) for i, j in pairs]
    apart = max(*(gap for _, gap in met), float(np.linalg.norm(met[1][0] - met[2][0])))
    return passive[0] if apart <= _MEET * size else None


def _frames(chain: SerialChain, q: Array) -> list[Array]:
    """Return the frames of all joints of a chain in the base, z along their axes, and the tip's."""
    T, frames = np.eye(4), []
    for k, constant in enumerate(chain.transforms):
        frames.append(T @ constant)
        if k < chain.n:
            T = frames[-1] @ joint_transform(bool(chain.types[k] == PRISMATIC), float(q[k]))
    return frames


def _meeting(one: Array, two: Array) -> tuple[Array, float]:
    """Return the point in which the z axes of two frames meet, and how far they miss (m)."""
    a, b, way = one[:3, 2], two[:3, 2], two[:3, 3] - one[:3, 3]
    normal = np.cross(a, b)
    square = float(normal @ normal)
    if square < _ACROSS**2:
        return one[:3, 3], np.inf
    along = float(np.cross(way, b) @ normal) / square
    return one[:3, 3] + along * a, abs(float(way @ normal)) / square**0.5
