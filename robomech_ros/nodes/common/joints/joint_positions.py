"""Joint positions as requests give them: named, unnamed, or left to the present state."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
from sensor_msgs.msg import JointState

from robomech_ros.errors import WrongSizeError
from robomech_ros.nodes.common.joints.closed_loop_positions import ClosedLoopPositions
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.joint_messages import positions_by_name
from robomech_ros.nodes.common.parameters import changeable
from robomech_ros.nodes.common.robot.robot_description import FrameSettings, RobotModel
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.parallel import Mechanism

# A chain that moves a link, or all limbs of a parallel robot.
Linkage: TypeAlias = "SerialChain | Mechanism"


@dataclass(frozen=True)
class StateSettings(FrameSettings):
    """Parameters of a node whose requests may leave the state to the present one."""

    state_timeout: float = changeable(
        1.0,
        "Longest wait of a request for the first joint state or for a frame, if it needs one; "
        "other requests are served meanwhile. 0 = no wait",
        (0.0, 60.0, "s"),
    )


class JointPositions:
    """Reads joint positions (rad or m) for the chains of one robot.

    A state without names has one position for every joint of the configured chain, in its order,
    whichever link it serves; for the chain to another link it may also have one for every joint
    of that chain.  One with the name of a posture in the place of a joint's, and no position, is
    that posture.  For a parallel robot states are read by :class:`ClosedLoopPositions`, whatever
    part of its joints is asked for.

    - ``model``: the robot; joints of it that are not in a chain may stand in a state and are passed
      over.
    """

    def __init__(self, model: RobotModel, monitor: JointStateMonitor) -> None:
        self._model = model
        self._monitor = monitor
        #: Reads postures of a parallel robot; None for other robots.
        self.loops = None if model.mechanism is None else ClosedLoopPositions(model.mechanism)

    def read(self, chain: Linkage, state: JointState, what: str) -> Array:
        """Read the required positions of a request, shape (n,)."""
        if self.loops is not None:
            return self._of(chain, self.loops.read(state, what, self.present_posture()))
        return self._read(cast(SerialChain, chain), state, what)

    def present_posture(self) -> Array | None:
        """Return all present joints (n,) of a parallel robot, or None if they are unknown."""
        loops = self.loops
        found = None if loops is None else self._monitor.positions(loops.mechanism.joint_names)
        return None if loops is None or found is None else loops.closed(found, "the present state")

    def _of(self, linkage: Linkage, q: Array) -> Array:
        """Pick the joints of a linkage from all joints (n,) of a parallel robot."""
        assert self.loops is not None
        at = dict(zip(self.loops.mechanism.joint_names, q, strict=True))
        return np.array([at[name] for name in linkage.joint_names])

    def _read(self, chain: SerialChain, state: JointState, what: str) -> Array:
        whole, size = self._model.chain, len(state.position)
        if not size and len(state.name) == 1 and state.name[0] not in self._model.joint_names:
            return self._model.posture(chain, state.name[0])
        if not state.name and chain is not whole:
            if size == whole.n:
                values = self.read(whole, state, what)
                state = JointState(name=list(whole.joint_names), position=values.tolist())
            elif size != chain.n:
                expected = (
                    f"{whole.n} for {', '.join(whole.joint_names)}, or {chain.n} for the joints "
                    f"up to link '{chain.tip}'"
                )
                raise WrongSizeError(f"{what}.position", size, expected)
        return positions_by_name(state, chain.joint_names, what, self._model.joint_names)

    async def read_or_present(
        self, chain: Linkage, state: JointState, what: str, patience: float
    ) -> Array:
        """Read the positions, shape (n,); an empty state means the present ones.

        Raises NoStateError: they are not known, even after waiting for `patience` (s).
        """
        if not is_empty(state):
            return self.read(chain, state, what)
        return await self.at_rest(chain, patience, math.inf)

    async def at_rest(self, chain: Linkage, patience: float, tolerance: float) -> Array:
        """Read the present positions, shape (n,), of a robot at rest.

        Raises NoStateError: they are not known, even after waiting for `patience` (s).
        RobotMovesError: a joint is faster than `tolerance` (rad/s or m/s), and was so all that
        time.
        """
        # The drives of a parallel robot determine its other joints.
        names = chain.joint_names if self.loops is None else self.loops.mechanism.actuated
        reported = await self._monitor.wait_for(names, patience, tolerance, self._model.units)
        if self.loops is None:
            return reported
        found = self.present_posture()
        if found is None:
            found = self.loops.complete(reported, "the present state")
        return self._of(chain, found)

    def seed(self, chain: Linkage, state: JointState) -> Array:
        """Read a seed, shape (n,); an empty state means the present positions or the mid-range.

        A present position outside the limits is taken at the limit: a robot at its stop, as it
        reports itself, must not make a request fail that says nothing about a seed.
        """
        if not is_empty(state):
            return self.read(chain, state, "seed")
        if self.loops is not None:
            known = self.present_posture()
            return self._of(chain, self.loops.mechanism.home() if known is None else known)
        assert isinstance(chain, SerialChain)
        present = self._monitor.positions(chain.joint_names)
        return chain.midrange() if present is None else np.clip(present, chain.lower, chain.upper)


def is_empty(state: JointState) -> bool:
    """Return whether a state names no joints and gives no positions."""
    return not state.name and not state.position
