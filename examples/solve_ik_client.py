"""Ask the running suite for every solution of a pose: a client of the service SolveIK.

Start the suite first:  robomech bringup --robot puma560
Then run:               python examples/solve_ik_client.py
"""

import sys

import rclpy
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion
from rclpy.signals import SignalHandlerOptions

from robomech_interfaces.srv import SolveIK

SERVICE = "kinematics/solve_ik"


def main() -> int:
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # Ctrl-C interrupts as usual
    node = rclpy.create_node("solve_ik_client")
    client = node.create_client(SolveIK, SERVICE)
    try:
        if not client.wait_for_service(timeout_sec=2.0):
            print(f"waiting for {SERVICE}; is the suite running?", file=sys.stderr)
            if not client.wait_for_service(timeout_sec=28.0):
                return 1
        pose = Pose(
            position=Point(x=0.6, y=0.1, z=0.4), orientation=Quaternion(x=0.5, y=0.5, z=0.5, w=0.5)
        )
        # An empty frame_id is the base, an empty seed the present joint state.
        future = client.call_async(SolveIK.Request(target=PoseStamped(pose=pose)))
        rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
        answer = future.result()
        if answer is None or answer.error_code:
            print("no solution:", answer.error_msg if answer else "no answer within 5 s")
            return 1
        print(f"{len(answer.solutions)} solutions, provably all: {answer.complete}")
        for point, branch in zip(answer.solutions, answer.branches, strict=True):
            print(f"    {[round(q, 3) for q in point.positions]}  {branch}")
        return 0
    except KeyboardInterrupt:
        return 130
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    sys.exit(main())
