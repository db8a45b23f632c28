"""Plan a motion and execute it on the simulated robot, by two services.

Start the suite first:  robomech bringup --robot puma560
Then run:               python examples/plan_and_execute_client.py
"""

import sys
import time

import rclpy
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState

from robomech_interfaces.srv import Execute, PlanJoint

GOAL = [0.5, 0.8, -0.6, 0.4, 0.5, 0.3]  # rad


def call(node, kind, service, request):
    """Call a service and return its answer, or end the program with the reason."""
    client = node.create_client(kind, service)
    if not client.wait_for_service(timeout_sec=2.0):
        print(f"waiting for {service}; is the suite running?", file=sys.stderr)
        if not client.wait_for_service(timeout_sec=28.0):
            sys.exit(1)
    future = client.call_async(request)
    end = time.monotonic() + 60.0
    while not future.done() and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.5)
    answer = future.result()
    if answer is None or answer.error_code:
        sys.exit(f"{service}: {answer.error_msg if answer else 'no answer within 60 s'}")
    return answer


def main() -> None:
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # Ctrl-C interrupts as usual
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
    except KeyboardInterrupt:
        sys.exit(130)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
