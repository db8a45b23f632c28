"""Joint positions as requests give them: named, unnamed, or left to the present state."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import JointState

from robomech_ros.errors import WrongSizeError
from robomech_ros.nodes.common.joint_messages import positions_by_name
from robomech_ros.nodes.common.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.parameters import parameter
from robomech_ros.nodes.common.robot_description import FrameSettings, RobotModel
from robomech_ros.robots import SerialChain
from robomech_ros.robots.following_chain import FollowingChain

__all__ = ["JointPositions", "StateSettings", "is_empty"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StateSettings(FrameSettings):
    """Parameters of a node whose requests may leave the state to the present one."""

    state_timeout: float = parameter(
        1.0,
        "How long a request that needs the present state waits for the first joint state, or for a "
        "frame that it names, while others are served. 0 = not at all",
        0.0,
        60.0,
        "s",
        read_only=False,
    )


class JointPositions:
    """Reads joint positions (rad or m) for the chains of one robot.

    A state without names has one position for every joint of the configured chain, in its order,
    whichever link it serves; for the chain to another link it may also have one for every joint
    of that chain.  One with the name of a posture in the place of a joint's, and no position, is
    that posture.

    Parameters
    ----------
    model : RobotModel
        The robot; joints of it that are not in a chain may stand in a state and are passed over.
    monitor : JointStateMonitor
        The present state.
    """

    def __init__(self, model: RobotModel, monitor: JointStateMonitor) -> None:
        self._model = model
        self._monitor = monitor

    def read(self, chain: SerialChain | FollowingChain, state: JointState, what: str) -> Array:
        """Read the positions, shape (n,), that a request must give."""
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
        self,
        chain: SerialChain | FollowingChain,
        state: JointState,
        what: str,
        patience: float,
    ) -> Array:
        """Read the positions, shape (n,); of an empty state, the present ones.

        Raises
        ------
        NoStateError
            They are not known, even after waiting for `patience` (s).
        """
        if is_empty(state):
            await self._monitor.wait_for(chain.joint_names, patience)
            return self._monitor.require(chain.joint_names)
        return self.read(chain, state, what)

    async def at_rest(self, chain: SerialChain, patience: float, tolerance: float) -> Array:
        """Read the present positions, shape (n,), of a robot that stands.

        Raises
        ------
        NoStateError
            They are not known, even after waiting for `patience` (s).
        RobotMovesError
            A joint is faster than `tolerance` (rad/s or m/s), and was so all that time.
        """
        await self._monitor.wait_for(chain.joint_names, patience, tolerance)
        return self._monitor.require_rest(chain.joint_names, tolerance, self._model.units)

    def seed(self, chain: SerialChain, state: JointState) -> Array:
        """Read a seed, shape (n,); of an empty state, the present positions or the mid-range.

        A present position outside the limits is taken at the limit: a robot at its stop, as it
        reports itself, must not make a request fail that says nothing about a seed.
        """
        if not is_empty(state):
            return self.read(chain, state, "seed")
        present = self._monitor.positions(chain.joint_names)
        return chain.midrange() if present is None else np.clip(present, chain.lower, chain.upper)

    async def rows(
        self,
        chains: Sequence[SerialChain | FollowingChain],
        states: Sequence[JointState],
        patience: float,
    ) -> list[Array]:
        """Read the positions of many states for many chains; of no states, the present ones.

        Returns
        -------
        list of ndarray, shape (m, n)
            For each chain the positions of its n joints in all m states.
        """
        if not states:
            empty = JointState()
            return [
                (await self.read_or_present(chain, empty, "states", patience))[None, :]
                for chain in chains
            ]
        return [
            np.array([self.read(chain, state, f"states[{i}]") for i, state in enumerate(states)])
            for chain in chains
        ]


def is_empty(state: JointState) -> bool:
    """Whether a state names no joints and gives no positions."""
    return not state.name and not state.position
