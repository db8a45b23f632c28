"""check_state_validity: whether a state touches anything or breaks a constraint."""

from collections.abc import Callable
from typing import Any

from moveit_msgs.msg import ConstraintEvalResult, Constraints, ContactInformation, MoveItErrorCodes
from moveit_msgs.srv import GetStateValidity
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_ros.collision import Clearance
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.nodes.move_group.settings import MoveGroupSettings
from robomech_ros.nodes.moveit.constraints import Conditions, frames_of
from robomech_ros.nodes.moveit.serving import chain_of, refused_as
from robomech_ros.nodes.moveit.whole_robot import WholeRobot

_KINDS = ("joint_constraints", "position_constraints", "orientation_constraints")


class ValidityService:
    """The service check_state_validity, whose errors are in the log: its answer has no text."""

    def __init__(
        self,
        node: Node,
        robot: WholeRobot,
        settings: Callable[[], MoveGroupSettings],
        scenes: Scenes,
    ) -> None:
        self._robot, self._settings, self._scenes = robot, settings, scenes
        self._log = ThrottledLog(node.get_logger())
        group = ReentrantCallbackGroup()
        serve(node, GetStateValidity, "check_state_validity", self._check, callback_group=group)

    async def _check(self, request: Any, response: Any) -> Any:
        try:
            await self._judge(request, response)
        except RobomechError as error:
            self._log.warning(f"check_state_validity refused: {error}")
            return GetStateValidity.Response(valid=False)
        return response

    async def _judge(self, request: Any, response: Any) -> None:
        robot, patience = self._robot, self._settings().state_timeout
        if request.group_name:
            chain_of(robot.model, request.group_name, "")
        places = await robot.places(frames_of(request.constraints), patience)
        with refused_as(MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS):
            # The whole first: it refuses what cannot be judged.
            Conditions(request.constraints, robot, places)
            conditions = [
                Conditions(Constraints(**{kind: [one]}), robot, places, kind)
                for kind in _KINDS
                for one in getattr(request.constraints, kind)
            ]
        given = robot.read(request.robot_state)
        positions = await robot.with_needed(given, robot.model.chain.joint_names, patience)
        positions = robot.with_defaults(positions)
        broken = [bool(one.broken(positions)) for one in conditions]
        response.constraint_result = [ConstraintEvalResult(result=not one) for one in broken]
        found = self._scenes.nearest(positions)
        if found is not None and found.distance <= 0.0:
            response.contacts = [self._contact(found)]
        response.valid = not response.contacts and not any(broken)

    def _contact(self, found: Clearance) -> ContactInformation:
        contact = ContactInformation(depth=-float(found.distance))
        contact.header.frame_id = self._robot.model.base_frame
        first, second = found.points
        middle, apart = 0.5 * (first + second), second - first
        contact.position.x, contact.position.y, contact.position.z = middle.tolist()
        length = float((apart @ apart) ** 0.5)
        if length:
            normal = contact.normal
            normal.x, normal.y, normal.z = (apart / length).tolist()
        contact.contact_body_1, contact.contact_body_2 = found.bodies
        contact.body_type_1, contact.body_type_2 = map(self._type, found.bodies)
        return contact

    def _type(self, name: str) -> int:
        one = self._scenes.world.objects.get(name)
        if one is None:
            return int(ContactInformation.ROBOT_LINK)
        attached = bool(one.link)
        kind = ContactInformation.ROBOT_ATTACHED if attached else ContactInformation.WORLD_OBJECT
        return int(kind)
