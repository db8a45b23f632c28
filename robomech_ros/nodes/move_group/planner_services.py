"""Services about the planners and their parameters."""

from collections.abc import Callable
from typing import Any

from moveit_msgs.msg import PlannerInterfaceDescription
from moveit_msgs.srv import GetPlannerParams, QueryPlannerInterfaces, SetPlannerParams
from rclpy.node import Node
from rclpy.parameter import Parameter

from robomech_ros.collision.libraries import PLANNERS
from robomech_ros.nodes.common.parameters import table_rows
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.move_group.settings import MoveGroupSettings
from robomech_ros.nodes.moveit.motion_request import PIPELINE
from robomech_ros.robots.documents.numbers_in_text import integer, number

# Planner parameters of the node, for every group, and the readers of their values.
_PARAMETERS: dict[str, Callable[[str], Any]] = {
    "planner": str,
    "planning_time": number,
    "clearance": number,
    "seed": integer,
}


class PlannerServices:
    """The services query_planner_interface, get_planner_params and set_planner_params.

    All planners and groups have the same parameters: some of the node.
    """

    def __init__(self, node: Node, settings: Callable[[], MoveGroupSettings]) -> None:
        self._node, self._settings = node, settings
        self._log = ThrottledLog(node.get_logger())
        self._rows = {row.name: row for row in table_rows(MoveGroupSettings)}
        for kind, name, callback in (
            (QueryPlannerInterfaces, "query_planner_interface", self._query),
            (GetPlannerParams, "get_planner_params", self._get),
            (SetPlannerParams, "set_planner_params", self._set),
        ):
            serve(node, kind, name, callback)

    def _query(self, request: Any, response: Any) -> Any:
        response.planner_interfaces = [
            PlannerInterfaceDescription(
                name="OMPL", pipeline_id=PIPELINE, planner_ids=list(PLANNERS)
            )
        ]
        return response

    def _get(self, request: Any, response: Any) -> Any:
        settings = self._settings()
        response.params.keys = list(_PARAMETERS)
        response.params.values = [str(getattr(settings, name)) for name in _PARAMETERS]
        response.params.descriptions = [self._rows[name].description for name in _PARAMETERS]
        return response

    def _set(self, request: Any, response: Any) -> Any:
        """Set parameters; the answer has no text, so that the log says what is refused."""
        given = dict(zip(request.params.keys, request.params.values, strict=False))
        if request.replace:
            given = {name: str(self._rows[name].default) for name in _PARAMETERS} | given
        for name, text in given.items():
            if name not in _PARAMETERS:
                known = ", ".join(_PARAMETERS)
                self._log.warning(f"planner parameter {name[:100]!r} is not one of {known}")
                continue
            try:
                value = _PARAMETERS[name](text)
            except (ValueError, TypeError) as error:
                self._log.warning(f"planner parameter '{name}': {error}")
                continue
            result = self._node.set_parameters([Parameter(name, value=value)])[0]
            if not result.successful:
                self._log.warning(f"planner parameter '{name}': {result.reason}")
        return response
