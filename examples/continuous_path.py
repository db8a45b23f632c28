"""Follow a straight line with the tool on one branch of inverse kinematics, and see where it ends.

Run it with:  python examples/continuous_path.py
"""

import numpy as np

from robomech_ros.cartesian import follow_path, plan_along, waypoint_path
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot

chain = load_robot("puma560")
q = np.array([0.1, -0.5, 0.4, 0.3, 0.8, 0.2])  # rad; it chooses the branch
start = forward_kinematics(chain, q)

for distance in (0.1, 0.5):  # the second line goes beyond a joint limit
    goal = start.copy()
    goal[2, 3] -= distance
    path = waypoint_path(start, [goal])
    followed = follow_path(chain, path, q)
    print(f"{distance} m down: {100 * followed.fraction:.0f} % followed")
    if followed.stop:
        print(f"    {followed.stop.kind.name}: {followed.stop.text}")
    for s in np.linspace(0.0, followed.fraction * path.length, 4):
        joints = followed.joints.derivatives(s)[0]
        error = np.abs(forward_kinematics(chain, joints) - path.sample(s).pose).max()
        print(f"    s = {s:.3f} m: q = {joints.round(3)}, off the line by {error:.0e}")

    plan = plan_along(chain, path, q, profile="poly345")  # the part that can be followed, in time
    print(f"    as a motion from rest to rest: {plan.trajectory.duration:.2f} s")
