"""Limits that a URDF cannot hold, assumed where nobody gave them."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from robomech_ros.errors import MissingLimitsError
from robomech_ros.robots import SerialChain, load_description, main_chain, semantics_of

__all__ = ["Which", "robot_with_limits"]

# A joint comes to full speed, and to full acceleration, in this many seconds.
_TO_SPEED = 0.25
_TO_ACCELERATION = 0.1


@dataclass(frozen=True)
class Which:
    """Which robot, and what of it, moves.

    Parameters
    ----------
    robot : str
        Name or path.
    srdf : str, optional
        Path of an SRDF.
    group : str, optional
        Of the SRDF.
    """

    robot: str
    srdf: str = ""
    group: str = ""

    def chain(self) -> SerialChain:
        """Load it; its home is that of the SRDF."""
        description = load_description(self.robot)
        return main_chain(description, semantics_of(description, self.srdf), group=self.group)


@contextmanager
def robot_with_limits(which: Which) -> Iterator[tuple[Which, SerialChain, str]]:
    """Give a robot that has acceleration and jerk limits.

    Parameters
    ----------
    which : Which

    Yields
    ------
    which : Which
        The same; or, where a URDF comes without these limits, a copy beside a YAML file with
        limits from the velocity limits.
    chain : SerialChain
        It, loaded.
    notice : str
        What was assumed; empty if nothing.

    Raises
    ------
    MissingLimitsError
        There are no velocity limits either, or the robot is not a URDF file.
    """
    chain = which.chain()
    chain.require_limits("velocity")
    lacking = [kind for kind in ("acceleration", "jerk") if np.isnan(getattr(chain, kind)).any()]
    if not lacking:
        yield which, chain, ""
        return
    path = Path(which.robot).expanduser()
    if path.suffix.lower() != ".urdf":
        kind = lacking[0]
        names = zip(chain.joint_names, np.isnan(getattr(chain, kind)), strict=True)
        raise MissingLimitsError(kind, [name for name, missing in names if missing])
    with TemporaryDirectory(prefix="robomech-demo-") as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(path.read_bytes())
        limits = _assumed(chain)
        text = json.dumps({"source": f"{path}; assumed for a demonstration", "joints": limits})
        copy.with_suffix(".yaml").write_text(text, encoding="utf-8")
        notice = (
            f"{path.name} gives no {' and no '.join(lacking)} limits (URDF cannot); assumed: full "
            f"speed in {_TO_SPEED:g} s, full acceleration in {_TO_ACCELERATION:g} s"
        )
        used = replace(which, robot=str(copy))
        yield used, used.chain(), notice


def _assumed(chain: SerialChain) -> dict[str, dict[str, float]]:
    acceleration = np.where(
        np.isnan(chain.acceleration), chain.velocity / _TO_SPEED, chain.acceleration
    )
    jerk = np.where(np.isnan(chain.jerk), acceleration / _TO_ACCELERATION, chain.jerk)
    return {
        name: {"acceleration": float(a), "jerk": float(j)}
        for name, a, j in zip(chain.joint_names, acceleration, jerk, strict=True)
    }
