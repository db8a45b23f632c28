"""A client that sends goals and requests, says so, and never ends by itself."""

import signal

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.srv import SolveIK
from robomech_ros.nodes.middleware.queue_depth import ask, ask_action

PATIENCE = 60.0

if __name__ == "__main__":
    rclpy.init()
    node = Node("victim")
    node.create_subscription(JointState, "joint_states", lambda _: None, 10)
    client = ask(node, SolveIK, "kinematics/solve_ik")
    goals = ask_action(node, ExecuteTrajectory, "joint_trajectory_controller/execute_trajectory")
    client.wait_for_service(PATIENCE)
    goals.wait_for_server(PATIENCE)
    client.call_async(SolveIK.Request())
    goals.send_goal_async(ExecuteTrajectory.Goal())
    print("waits", flush=True)
    signal.pause()
