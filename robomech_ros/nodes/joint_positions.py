"""Joint positions as requests give them: named, unnamed, or left to the present state."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import JointState

from robomech_ros.nodes.conversions import positions_by_name
from robomech_ros.nodes.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.robot_description import RobotModel
from robomech_ros.robots import SerialChain

__all__ = ["JointPositions"]

Array = NDArray[np.float64]


class JointPositions:
    """Reads joint positions (rad or m) for the chains of one robot.

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

    def given(self, chain: SerialChain, state: JointState, what: str) -> Array:
        """Read the positions, shape (n,), that a request must give."""
        return positions_by_name(state, chain.joint_names, what, self._model.joint_names)

    def given_or_present(self, chain: SerialChain, state: JointState, what: str) -> Array:
        """Read the positions, shape (n,); of an empty state, the present ones.

        Raises
        ------
        NoStateError
            They are not known.
        """
        if is_empty(state):
            return self._monitor.require(chain.joint_names)
        return self.given(chain, state, what)

    def seed(self, chain: SerialChain, state: JointState) -> Array:
        """Read a seed, shape (n,); of an empty state, the present positions or the mid-range.

        A present position outside the limits is taken at the limit: a robot at its stop, as it
        reports itself, must not make a request fail that says nothing about a seed.
        """
        if not is_empty(state):
            return self.given(chain, state, "seed")
        present = self._monitor.positions(chain.joint_names)
        return chain.midrange() if present is None else np.clip(present, chain.lower, chain.upper)

    def rows(self, chain: SerialChain, states: Sequence[JointState]) -> Array:
        """Read the positions of many states, shape (m, n); of no states, the present ones.

        A state without names is in the order of the configured chain, whichever link it serves.
        """
        if not states:
            return self._monitor.require(chain.joint_names)[None, :]
        return np.array([self._row(chain, state, i) for i, state in enumerate(states)])

    def _row(self, chain: SerialChain, state: JointState, index: int) -> Array:
        what = f"states[{index}]"
        if state.name or chain is self._model.chain:
            return self.given(chain, state, what)
        whole = self._model.chain
        values = self.given(whole, state, what)
        named = JointState(name=list(whole.joint_names), position=values.tolist())
        return self.given(chain, named, what)


def is_empty(state: JointState) -> bool:
    """Whether a state names no joints and gives no positions."""
    return not state.name and not state.position
