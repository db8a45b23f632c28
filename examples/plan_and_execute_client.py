"""Plan a motion and execute it on the simulated robot, by two services.

Start the suite first:  robomech bringup --robot puma560
Then run:               python examples/plan_and_execute_client.py
"""

import sys

import rclpy
from sensor_msgs.msg import JointState

from robomech_interfaces.srv import Execute, PlanJoint

GOAL = [0.5, 0.8, -0.6, 0.4, 0.5, 0.3]  # rad


def call(node, kind, service, request):
    """Call a service and return its answer, or end the program with the reason."""
    client = node.create_client(kind, service)
    if not client.wait_for_service(timeout_sec=30.0):
        sys.exit(f"nobody serves {service}; is the suite running?")
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=60.0)
    answer = future.result()
    if answer is None or answer.error_code:
        sys.exit(f"{service}: {answer.error_msg if answer else 'no answer within 60 s'}")
    return answer


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("plan_and_execute_client")
    try:
        # Without a start the plan begins where the robot is.
        request = PlanJoint.Request(
            goal=JointState(position=GOAL), profile=PlanJoint.Request.RUCKIG, velocity_scale=0.5
        )
        plan = call(node, PlanJoint, "trajectory_planner/plan_joint", request)
        seconds = plan.duration.sec + 1e-9 * plan.duration.nanosec
        print(f"planned {len(plan.trajectory.points)} points, {seconds:.2f} s")
        # Without points: the trajectory planned last.  The answer comes when the robot is there.
        call(node, Execute, "trajectory_publisher/execute", Execute.Request())
        print(f"arrived at {GOAL}")
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
