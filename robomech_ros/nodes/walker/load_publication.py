"""Published loads of a walk: ground forces on the feet, and torques of all joints."""

import numpy as np
from geometry_msgs.msg import Transform, Wrench
from rclpy.node import Node
from sensor_msgs.msg import JointState, MultiDOFJointState

from robomech_ros.errors import MissingInertiaError, RobomechError
from robomech_ros.nodes.common.messages.message_fields import fill_header, floats
from robomech_ros.nodes.walker.settings import WalkerSettings
from robomech_ros.nodes.walker.stream import WalkStream
from robomech_ros.walking import LeggedRobot, WalkingDynamics
from robomech_ros.walking.gait_loads import step_loads

_DEPTH = 10


class LoadPublication:
    """Publishes forces at the feet and joint torques of a walk, if somebody subscribes to them."""

    def __init__(self, node: Node, robot: LeggedRobot, settings: WalkerSettings) -> None:
        self._odom = settings.frame_prefix + settings.odom_frame_id
        self._friction, self.refusal = settings.foot_friction, ""
        self._forces = node.create_publisher(MultiDOFJointState, "~/foot_forces", _DEPTH)
        self._efforts = node.create_publisher(JointState, "~/joint_efforts", _DEPTH)
        self._robot, self._dynamics = robot, None
        try:
            self._dynamics = WalkingDynamics(robot)
        except MissingInertiaError as error:
            #: Why the latest loads were not published; empty if they were.
            self.refusal = str(error)

    def publish(self, stream: WalkStream, stamp: int) -> None:
        """Publish the loads of the present knot of a walk, at a ROS time (ns)."""
        publishers = self._forces, self._efforts
        if self._dynamics is None or not any(one.get_subscription_count() for one in publishers):
            return
        three, robot = stream.around_present, self._robot
        try:
            u, share = step_loads(
                self._dynamics, three, stream.walker.period, friction=self._friction
            )
        except RobomechError as error:
            self.refusal = str(error)
            return
        self.refusal = ""
        forces = MultiDOFJointState(joint_names=list(robot.leg_names))
        fill_header(forces.header, self._odom, stamp)
        over_ground = share.forces @ three[1].trunk[:3, :3].T
        for foot, force in zip(three[1].feet.tolist(), over_ground.tolist(), strict=True):
            position, wrench = Transform(), Wrench()
            shift = position.translation
            shift.x, shift.y, shift.z = foot
            wrench.force.x, wrench.force.y, wrench.force.z = force
            forces.transforms.append(position)
            forces.wrench.append(wrench)
        self._forces.publish(forces)
        efforts = JointState(name=list(robot.joint_names))
        fill_header(efforts.header, "", stamp)
        efforts.position, efforts.velocity = floats(three[1].q), floats(np.ascontiguousarray(u[6:]))
        efforts.effort = floats(share.torques)
        self._efforts.publish(efforts)
