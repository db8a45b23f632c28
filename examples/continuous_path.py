"""Follow a straight line with the tool, always on the branch of inverse kinematics it starts on.

Run it with:  python examples/continuous_path.py
"""

from functools import partial

import numpy as np

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import SerialArm, straight_path, track_path

chain = load_robot("puma560")


def nearest(pose, near):
    """Choose the solution nearest to some joint values, None where there is none."""
    found = inverse_kinematics(chain, pose, seed=near, respect_limits=False).q
    return found[0] if len(found) else None


arm = SerialArm(partial(forward_kinematics, chain), nearest, partial(jacobian, chain))
q = np.array([0.1, -0.5, 0.4, 0.3, 0.8, 0.2])
start = arm.forward(q)

for distance in (0.2, 2.0):  # the second goal is out of reach
    goal = start.copy()
    goal[2, 3] -= distance
    path = straight_path([start, goal])
    followed = track_path(path, arm, q)
    print(f"{distance} m down: {followed.status.name}, {followed.reached:.3f} m {followed.reason}")
    for s in np.linspace(0.0, followed.reached, 4):
        joints = followed.path.derivatives(s)[0]
        error = np.abs(arm.forward(joints) - path.sample(s).pose).max()
        print(f"    s = {s:.3f} m: q = {joints.round(3)}, off the line by {error:.0e}")
