"""Common part of all services with MoveIt types: errors in MoveIt's codes, chains of groups."""

import traceback
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Protocol

from moveit_msgs.msg import MoveItErrorCodes
from rclpy.node import Node

from robomech_ros.collision import PlanningScene
from robomech_ros.errors import RobomechError, UnknownLinkError
from robomech_ros.nodes.common.messages.error_codes import (
    FrameUnavailableError,
    NoStateError,
    RobotMovesError,
)
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.robots import SerialChain


class Collisions(Protocol):
    """Collision checks that answers need."""

    async def of(self, chain: SerialChain, positions: Mapping[str, float]) -> PlanningScene:
        """Return the scene of a chain, the other joints of the robot at positions (rad or m)."""

    def contact(self, positions: Mapping[str, float]) -> str:
        """Say which bodies touch at positions (rad or m) of all joints; "" for none."""

    @property
    def unchecked(self) -> str:
        """Say what of the robot is not checked; "" if all of it is."""


_Callback = Callable[[Any, Any], Awaitable[Any]]
# Errors that mean the same in every part of a request.
_CODES = (
    (FrameUnavailableError, MoveItErrorCodes.FRAME_TRANSFORM_FAILURE),
    (RobotMovesError, MoveItErrorCodes.START_STATE_INVALID),
    (NoStateError, MoveItErrorCodes.ROBOT_STATE_STALE),
    (UnknownLinkError, MoveItErrorCodes.INVALID_LINK_NAME),
)


class RejectedError(RobomechError):
    """A request cannot be served; `code` is one of MoveItErrorCodes."""

    def __init__(self, code: int, reason: str) -> None:
        self.code = code
        self.reason = reason
        super().__init__(reason)


@contextmanager
def refused_as(code: int) -> Iterator[None]:
    """Turn what is found wrong with a part of a request into a refusal with this code.

    A frame, a present state or a link that is not known keeps the code of its own.
    """
    try:
        yield
    except RejectedError:
        raise
    except RobomechError as error:
        own = next((own for kind, own in _CODES if isinstance(error, kind)), code)
        raise RejectedError(own, str(error)) from error


class Outcomes:
    """Turns what becomes of requests into MoveIt's codes, whatever happens.

    - ``node``: the source of all answers.
    """

    def __init__(self, node: Node) -> None:
        self._source = node.get_fully_qualified_name()
        self._log = ThrottledLog(node.get_logger())

    async def of(self, work: Awaitable[tuple[int, str]]) -> tuple[MoveItErrorCodes, bool]:
        """Await work that returns one of MoveItErrorCodes and a text; an error is an outcome too.

        Returns whether the work came to its end, without an error.
        """
        ended = False
        try:
            code, text = await work
            ended = True
        except RejectedError as error:
            code, text = error.code, error.reason
        except RobomechError as error:
            code, text = MoveItErrorCodes.FAILURE, str(error)
        except Exception as error:
            self._log.error(f"a request failed, please report this:\n{traceback.format_exc()}")
            code = MoveItErrorCodes.FAILURE
            text = f"internal error, please report it: {type(error).__name__}: {error}"
        outcome = MoveItErrorCodes(val=int(code))
        # Some versions have no texts.
        if hasattr(outcome, "message"):
            outcome.message, outcome.source = text, self._source
        return outcome, ended


def answering(node: Node, callback: _Callback) -> _Callback:
    """Guard a callback so that it always answers; the node goes on serving.

    The callback fills the response and returns one of MoveItErrorCodes and a text.
    """
    outcomes = Outcomes(node)

    async def call(request: Any, response: Any) -> Any:
        outcome, ended = await outcomes.of(callback(request, response))
        if not ended:
            response = type(response)()
        response.error_code = outcome
        return response

    return call


def chain_of(model: RobotModel, group: str, link: str) -> SerialChain:
    """Return the chain of a group to a link that its joints move.

    Without a group it begins at the configured base; without a link it ends at the tip.
    """
    if group and group not in model.groups:
        listed = " or ".join(f"'{one}'" for one in model.groups)
        why = model.semantic.left_out.get(group)
        raise RejectedError(
            MoveItErrorCodes.INVALID_GROUP_NAME,
            f"group_name is {group[:200]!r}, expected {listed}, or empty for the configured chain"
            f"{f'; that group was left out: {why}' if why else ''}",
        )
    with refused_as(MoveItErrorCodes.INVALID_LINK_NAME):
        chain = model.chain_of(group, link)
    if not chain.n:
        raise RejectedError(
            MoveItErrorCodes.INVALID_LINK_NAME,
            f"link '{link}' is not moved by any joint: it is fixed to '{chain.base}'",
        )
    return chain
