"""Three joints at 1.1, 2.1 and 3.1 rad, as joint_trajectory_controller's own tests have them."""

import numpy as np
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Time
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from control_msgs.srv import QueryTrajectoryState
from drivers import NAME, TIMEOUT, Driver, ended, seconds
from rclpy.action import ActionClient
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

START = np.array([1.1, 2.1, 3.1])
JOINTS = ("joint1", "joint2", "joint3")
CODES = FollowJointTrajectory.Result
SUCCEEDED, ABORTED, CANCELED = (
    GoalStatus.STATUS_SUCCEEDED,
    GoalStatus.STATUS_ABORTED,
    GoalStatus.STATUS_CANCELED,
)
ZERO = np.zeros(3)
NEAR = START + np.array([0.1, -0.1, 0.05])
FAR = START + np.array([0.4, -0.3, 0.2])
# Longer than a busy machine takes to do something about the motion, s.
SLOWLY = 20.0


def _joint(number, kind):
    limits = "" if kind == "continuous" else 'lower="-6.2" upper="6.2"'
    return f"""
  <link name="link{number}"/>
  <joint name="joint{number}" type="{kind}">
    <parent link="link{number - 1}"/><child link="link{number}"/><origin xyz="0 0 0.3"/>
    <axis xyz="0 1 0"/><limit {limits} effort="10" velocity="5"/>
  </joint>"""


def three_joints(kind="revolute"):
    joints = "".join(_joint(number, kind) for number in (1, 2, 3))
    return f'<robot name="three"><link name="link0"/>{joints}</robot>'


class Follower(Driver):
    """Drives the controller by the types of control_msgs."""

    def __init__(self, graph, start, kind="revolute", **parameters):
        parameters.setdefault("robot_description", three_joints(kind))
        parameters.setdefault("initial_positions", START.tolist())
        super().__init__(graph, start, **parameters)
        self._follow = ActionClient(
            graph.client, FollowJointTrajectory, f"{NAME}/follow_joint_trajectory"
        )
        assert self._follow.wait_for_server(TIMEOUT)

    def points(self, *rows, names=JOINTS):
        """Make a trajectory of rows of (time, positions, velocities, accelerations)."""
        message = JointTrajectory(joint_names=list(names))
        for time, *states in rows:
            states = [list(map(float, state)) for state in states]
            states += [[]] * (3 - len(states))
            message.points.append(
                JointTrajectoryPoint(
                    positions=states[0],
                    velocities=states[1],
                    accelerations=states[2],
                    time_from_start=seconds(time),
                )
            )
        return message

    def stamped(self, trajectory, ahead):
        """Have it begin so many seconds from now."""
        now = self.graph.client.get_clock().now().nanoseconds + round(ahead * 1e9)
        trajectory.header.stamp = Time(sec=now // 10**9, nanosec=now % 10**9)
        return trajectory

    def send_goal(self, trajectory, feedback=None, **tolerances):
        goal = FollowJointTrajectory.Goal(trajectory=trajectory, **tolerances)
        handle = ended(self.ask(lambda: self._follow.send_goal_async(goal, feedback)))
        assert handle.accepted
        return handle

    def follow(self, trajectory, **tolerances):
        """Execute; returns status, code and text."""
        return self.outcome(self.send_goal(trajectory, **tolerances))

    def outcome(self, handle):
        status, result = self.result(handle)
        return status, result.error_code, result.error_string

    def query(self, ahead=0.0):
        """Ask for the state so many seconds from now; 0 = now, by the stamp 0."""
        message = self.stamped(JointTrajectory(), ahead) if ahead else JointTrajectory()
        return self.query_at(message.header.stamp)

    def query_at(self, stamp):
        """Ask for the state at an instant."""
        request = QueryTrajectoryState.Request(time=stamp)
        return self.graph.call(QueryTrajectoryState, f"{NAME}/query_state", request)

    def until_still(self):
        self.until(lambda: not self.velocity.any())


def tolerance(joint, position=0.0, velocity=0.0, acceleration=0.0):
    return JointTolerance(
        name=joint, position=position, velocity=velocity, acceleration=acceleration
    )


def lagging(follower, **parameters):
    """A robot that is behind its path by about the speed times 0.2 s."""
    return follower(tracking_lag=0.2, goal_time=5.0, **parameters)
