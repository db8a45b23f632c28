"""Move the simulated robot as MoveIt does: a client of the action FollowJointTrajectory.

It knows nothing of robomech_ros, so it drives any controller of ros2_control as well.

Start the suite first:  robomech bringup --robot puma560
Then run:               python examples/follow_joint_trajectory_client.py
"""

import sys

import rclpy
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from rclpy.signals import SignalHandlerOptions
from rclpy.wait_for_message import wait_for_message
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

ACTION = "joint_trajectory_controller/follow_joint_trajectory"


def main() -> int:
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # Ctrl-C interrupts as usual
    node = rclpy.create_node("follow_joint_trajectory_client")
    client = ActionClient(node, FollowJointTrajectory, ACTION)
    try:
        for attempt in range(15):
            heard, state = wait_for_message(JointState, node, "joint_states", time_to_wait=2.0)
            if heard and client.wait_for_server(timeout_sec=2.0):
                break
            if not attempt:
                print(f"waiting for joint_states and {ACTION}; is the suite up?", file=sys.stderr)
        else:
            return 1
        # Two points with velocities: the controller joins them by cubics.
        goal = FollowJointTrajectory.Goal(trajectory=JointTrajectory(joint_names=state.name))
        for seconds, turn in ((1, 0.1), (2, 0.2)):
            point = JointTrajectoryPoint(time_from_start=Duration(sec=seconds))
            point.positions = [q + turn for q in state.position]
            point.velocities = [0.1 if seconds == 1 else 0.0] * len(state.name)
            goal.trajectory.points.append(point)
        sent = client.send_goal_async(goal)
        rclpy.spin_until_future_complete(node, sent, timeout_sec=10.0)
        ended = sent.result().get_result_async()
        rclpy.spin_until_future_complete(node, ended, timeout_sec=10.0)
        result = ended.result().result
        done = result.error_code == FollowJointTrajectory.Result.SUCCESSFUL
        print("arrived" if done else f"failed: {result.error_string}")
        return 0 if done else 1
    except KeyboardInterrupt:
        return 130
    finally:
        client.destroy()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    sys.exit(main())
