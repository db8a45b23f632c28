"""Floating base of a robot, from its document or a parameter."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.nodes.common.parameters import ParameterError, parameter
from robomech_ros.nodes.common.robot.robot_description import RobotModel, RobotSettings
from robomech_ros.outcomes import Code
from robomech_ros.robots import Body, SerialChain
from robomech_ros.robots.bodies import combine_bodies

if TYPE_CHECKING:
    from robomech_ros.dynamics import FloatingChain

AUTO, ALWAYS, NEVER = "auto", "always", "never"


@dataclass(frozen=True)
class FloatingSettings(RobotSettings):
    """Parameters of a node that serves robots on a floating base."""

    floating_base: str = parameter(
        AUTO,
        "Whether the base floats freely, as in space: auto = if the robot's document has a "
        "floating_base, always = with the masses of the links fixed to it, never = it is fixed",
        choices=(AUTO, ALWAYS, NEVER),
    )


class FloatingRobot:
    """A robot whose base may float."""

    def __init__(self, model: RobotModel, settings: FloatingSettings) -> None:
        self._model, wanted = model, settings.floating_base
        own = model.description.floating_base
        self.floats = wanted == ALWAYS or (wanted == AUTO and own is not None)
        if wanted == ALWAYS and (model.mechanism is not None or model.legged is not None):
            allowed = f"{AUTO} or {NEVER}: '{model.chain.name}' is no arm"
            raise ParameterError("floating_base", wanted, allowed)

    def carrying(self, chain: SerialChain) -> "FloatingChain":
        """Return a chain with all joints of the configured one on the floating base.

        Raises OutcomeError, MissingInertiaError, BadValueError: the mass of the base or of a link
        is unknown or impossible.
        """
        configured = self._model.chain
        if chain.joint_names != configured.joint_names:
            expected = f"a link that all joints of '{configured.name}' move: its base floats"
            raise BadValueError("tip_link", chain.tip, expected)
        # Compiled code is loaded only for such a robot.
        from robomech_ros.dynamics import FloatingChain

        return FloatingChain(chain, self._body)

    @cached_property
    def _body(self) -> Body:
        description, fixed = self._model.description, self._model.fixed_frames
        own = description.bodies
        if description.floating_base is not None and description.root in fixed:
            own = {description.root: description.floating_base}
        parts = [own[link].expressed_in(T) for link, T in fixed.items() if link in own]
        body = combine_bodies(parts)
        if body is None:
            base = self._model.chain.base
            text = (
                f"the base '{base}' floats, and no link fixed to it has a mass and inertia; give "
                f"them in the robot's description, or set floating_base to {NEVER}"
            )
            raise OutcomeError(Code.MISSING_INERTIA, text)
        return body


def check_momentum(momentum: Sequence[float]) -> None:
    """Reject a parameter that is not a momentum."""
    if len(momentum) not in (0, 6):
        allowed = "empty, or 6 numbers: angular x y z, linear x y z"
        raise ParameterError("momentum", list(momentum), allowed)
