"""What clients of move_group send."""

from functools import partial

import numpy as np
from geometry_msgs.msg import Pose
from moveit_msgs.msg import (
    AttachedCollisionObject,
    CollisionObject,
    MotionPlanRequest,
    PlanningScene,
    RobotState,
)
from moveit_msgs.srv import ApplyPlanningScene, GetPlanningScene
from rclpy.action import ActionClient
from shape_msgs.msg import SolidPrimitive
from shaped_arm import shaped_ur5e

from robomech_ros.nodes.common.joints.joint_limits import with_assumed_rates
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.moveit import goal_constraints
from robomech_ros.robots import load_description

UR5E = with_assumed_rates(load_description(shaped_ur5e()))[0].chain()
# The arm to one side of a wall at y = 0, and to the other.
HERE = np.array([0.6, -1.2, 1.6, -1.9, -1.5708, 0.0])
THERE = np.array([-1.0, -1.2, 1.6, -1.9, -1.5708, 0.0])


class Client:
    """Asks a move_group."""

    def __init__(self, graph):
        self.graph = graph
        self._actions = {}

    def apply(self, *objects, attached=(), **fields):
        """Apply a difference of the scene; say whether it was taken."""
        scene = PlanningScene(is_diff=True, **fields)
        scene.world.collision_objects = list(objects)
        scene.robot_state.is_diff = True
        scene.robot_state.attached_collision_objects = list(attached)
        return self.graph.ask(ApplyPlanningScene, "apply_planning_scene", scene=scene).success

    def send(self, kind, name, goal):
        """Send a goal; return its handle and the future of its result."""
        if name not in self._actions:
            make = partial(ActionClient, self.graph.client, kind, name)
            self._actions[name] = self._spinning(make)
        actions = self._actions[name]
        assert actions.wait_for_server(30.0)
        handle = self.graph.wait_for(self._spinning(partial(actions.send_goal_async, goal)))
        return handle, self._spinning(handle.get_result_async)

    def _spinning(self, work):
        """Do work in the thread that spins the client.

        An action client of rclpy that another thread makes is looked at before it is complete, and
        does not know an answer that comes at once.
        """
        return self.graph.wait_for(self.graph.client.executor.create_task(work))

    def scene(self, components=0):
        """Return the scene."""
        request = GetPlanningScene.Request()
        request.components.components = components
        return self.graph.call(GetPlanningScene, "get_planning_scene", request).scene


def state(q=HERE, **fields):
    """Make a state of the arm."""
    return RobotState(joint_state=joint_state(UR5E.joint_names, np.asarray(q, float)), **fields)


def box(name="wall", sizes=(1.0, 0.02, 1.0), position=(0.5, 0.0, 0.5), **fields):
    """Make a collision object with one box."""
    shape = SolidPrimitive(type=SolidPrimitive.BOX, dimensions=list(map(float, sizes)))
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = map(float, position)
    return CollisionObject(id=name, primitives=[shape], pose=pose, **fields)


def carried(one, link="tool0", **fields):
    """Make an attached collision object."""
    return AttachedCollisionObject(link_name=link, object=one, **fields)


def joint_goal(q, tolerance=1e-3):
    """Make goal constraints on all joints."""
    return goal_constraints.joint_goal(UR5E.joint_names, q, tolerance)


def pose_goal(T, link="tool0", tolerance=1e-3, frame=""):
    """Make goal constraints on the pose of a link."""
    return goal_constraints.pose_goal(T, link, tolerance, frame)


def request(*goals, start=HERE, **fields):
    """Make a request for a motion."""
    given = {"group_name": "manipulator", "start_state": state(start), **fields}
    return MotionPlanRequest(goal_constraints=list(goals), **given)
