"""The bodies of a parallel robot, and the friction and the rotors of its drives."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from robomech_ros.errors import BadValueError, UnknownLinkError
from robomech_ros.parallel.mechanism.limb import Limb
from robomech_ros.parallel.mechanism.tree import links_of_joints
from robomech_ros.robots import Body, Drive, SerialChain
from robomech_ros.robots.bodies import possible_body
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.poses import assembled, rigid_inverse
from robomech_ros.typing import Array

# Below this (m, or the sine of an angle) a direction is rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class LinkBodies:
    """Moving bodies of a parallel robot.

    Parameters
    ----------
    bodies : mapping of str to Body, optional
        By the names of links: of one limb (``leg2_rod``), or without its prefix of all limbs
        (``rod``); and of the platform, seen in its frame.  Links without one have no mass.  Frames
        of the others have their origin at the joint that moves the link, x along the link to the
        next joint, or along the slide where one of the two is prismatic, and z along the axis of
        the joint, as nearly as it can.
    drive : Drive, optional
        Friction and rotor of every drive.
    """

    bodies: Mapping[str, Body] = field(default_factory=dict)
    drive: Drive = field(default_factory=Drive)

    def __post_init__(self) -> None:
        if not isinstance(self.bodies, Mapping):
            raise BadValueError("bodies", self.bodies, "a mapping of names of links to bodies")
        for name, body in self.bodies.items():
            possible_body(f"body of '{name}'", body)
        if not isinstance(self.drive, Drive):
            raise BadValueError("drive", self.drive, "a Drive")


def limbs_with_parts(
    limbs: Sequence[Limb], platform: str, parts: LinkBodies
) -> tuple[tuple[Limb, ...], Body | None]:
    """Return limbs with the bodies of their links, and the body of the platform.

    The last joint of a limb moves the platform, so a limb has no body there.
    """
    left = {name: body for name, body in parts.bodies.items() if name != platform}
    known, found = [platform], []
    for limb in limbs:
        chain = limb.chain
        frames, bodies = _body_frames(chain), list(chain.bodies)
        for j, link in enumerate(links_of_joints(chain)[:-1]):
            names = link, link.partition("_")[2]
            known += [name for name in names if name]
            body = next((parts.bodies[name] for name in names if name in parts.bodies), None)
            if body is not None:
                bodies[j] = body.expressed_in(frames[j])
        drives = [
            parts.drive if name in limb.actuated and parts.drive != Drive() else own
            for name, own in zip(chain.joint_names, chain.drives, strict=True)
        ]
        chain = dataclasses.replace(chain, bodies=tuple(bodies), drives=tuple(drives))
        found.append(dataclasses.replace(limb, chain=chain))
    for name in left:
        if name not in known:
            raise UnknownLinkError(name, sorted(set(known)))
    return tuple(found), parts.bodies.get(platform)


def _body_frames(chain: SerialChain) -> list[Array]:
    """Return the frame of each joint's body in the frame that moves with the joint, (4, 4)."""
    constants = chain.transforms
    poses = [constants[0]]
    for step in constants[1:-1]:
        poses.append(poses[-1] @ step)
    slides = chain.types == PRISMATIC
    frames = []
    for j, pose in enumerate(poses):
        own, ahead = pose[:3, 2], poses[min(j + 1, chain.n - 1)]
        z = poses[max(j - 1, 0)][:3, 2] if slides[j] else own
        way = ahead[:3, 3] - pose[:3, 3]
        if slides[j]:
            x = own
        elif slides[min(j + 1, chain.n - 1)]:
            x = ahead[:3, 2]
        else:
            x = way if np.linalg.norm(way) > _ROUNDING else _across(ahead[:3, 2], own)
        if np.linalg.norm(x) <= _ROUNDING:
            x = pose[:3, 0]
        x = x / np.linalg.norm(x)
        z = _across(z, x)
        if np.linalg.norm(z) <= _ROUNDING:
            z = _across(pose[:3, int(np.argmin(np.abs(pose[:3, :3].T @ x)))], x)
        z = z / np.linalg.norm(z)
        R = np.stack((x, np.cross(z, x), z), axis=1)
        frames.append(rigid_inverse(pose) @ assembled(R, pose[:3, 3]))
    return frames


def _across(vector: Array, axis: Array) -> Array:
    """Return the part of a vector across a unit axis."""
    return vector - float(vector @ axis) * axis
