"""Interfaces of a dispatcher to the controller and to the robot's state."""

from collections.abc import Sequence
from typing import Protocol

from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.execution.joints import JointKinds
from robomech_ros.typing import Array


class ControllerInterface(Protocol):
    """The way to the controller and to the robot's state."""

    def missing(self, transport: Transport) -> str:
        """Name what a transport needs and does not find; empty if nothing."""

    @property
    def died(self) -> bool:
        """True if a controller that was there no longer shows signs of life."""

    @property
    def replaced(self) -> bool:
        """True if the controller that was sent to last has died, and another process is there."""

    def send(self, delivery: ExecutionRequest) -> None:
        """Send, instead of what was sent of this delivery before.

        By action, `Dispatcher.conclude` is called with the result of what was sent last.
        """

    def cancel(self, delivery: ExecutionRequest) -> None:
        """Ask the controller to give up a delivery sent by action."""

    def runs_before(self, delivery: ExecutionRequest) -> bool:
        """Return whether the controller still executes what was sent before of this delivery."""

    def positions(self, names: Sequence[str]) -> Array | None:
        """Return the present positions, rad or m; None if not known."""

    def update_count(self, names: Sequence[str]) -> int:
        """Return a counter that grows whenever all these joints have newer states."""

    def kinds(self, names: Sequence[str]) -> JointKinds:
        """Say which joints turn without limits, and in which units they are."""

    def acceleration(self, names: Sequence[str]) -> Array | None:
        """Return the acceleration limits, rad/s^2 or m/s^2; None if the robot is not known."""
