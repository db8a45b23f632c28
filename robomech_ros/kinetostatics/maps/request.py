"""The subject of a map: the robot, the grid, the orientations, and how postures are judged."""

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomech_ros import __version__
from robomech_ros.kinetostatics.maps.box_grid import BoxGrid
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array


@dataclass(frozen=True)
class RobotIdentity:
    """The chain of a map: its name, first and last link, and a digest of geometry and limits."""

    name: str
    base: str
    tip: str
    digest: str

    def __str__(self) -> str:
        return f"'{self.name}' from '{self.base}' to '{self.tip}' (digest {self.digest[:12]})"


@dataclass(frozen=True, eq=False)
class MapRequest:
    """Definition of a map.

    At each position of the tip in the grid, orientations ``R_base_tip`` (k, 3, 3) are tried.
    Linear rows of the Jacobian are divided by the length (m), and the part says which rows count.
    The version is that of robomech_ros, which computes the map.
    """

    robot: RobotIdentity
    grid: BoxGrid
    orientations: Array
    respect_limits: bool
    length: float
    part: str
    version: str = __version__

    @property
    def poses(self) -> int:
        """Number of poses."""
        return self.grid.cells * len(self.orientations)

    @cached_property
    def header(self) -> dict[str, Any]:
        """Everything but the orientations, which stand for themselves by their digest."""
        return {
            "robot": vars(self.robot),
            "lower": self.grid.lower.tolist(),
            "upper": self.grid.upper.tolist(),
            "shape": list(self.grid.shape),
            "orientations": _digest(self.orientations),
            "respect_limits": self.respect_limits,
            "length": self.length,
            "part": self.part,
            "version": self.version,
        }

    def difference(self, other: "MapRequest") -> str:
        """Say in which respect another request differs, empty where it is the same."""
        for name, mine in self.header.items():
            theirs = other.header[name]
            if mine != theirs:
                if name == "robot":
                    return f"it is of robot {self.robot}, not {other.robot}"
                return f"its {name} is {json.dumps(mine)}, not {json.dumps(theirs)}"
        return ""


def identity_of(chain: SerialChain) -> RobotIdentity:
    """Return what tells the map of a chain from that of another one."""
    arrays = (chain.types, chain.packed, chain.lower, chain.upper)
    return RobotIdentity(chain.name, chain.base, chain.tip, _digest(*arrays))


def _digest(*arrays: NDArray) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
