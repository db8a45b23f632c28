"""Run along a path as fast as the drives can: the shortest time within the torque limits.

Run it with:  python examples/time_optimal_torques.py
"""

from functools import partial

import numpy as np

from robomech_ros.dynamics import friction_torque, inverse_dynamics
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import Limits, spline_through, torque_limited

chain = load_robot("puma560")
points = [
    [0.0, 0.8, -0.6, 0.0, 0.5, 0.0],
    [0.9, 0.2, 0.3, -0.7, -0.4, 0.8],
    [0.3, 0.4, 0.1, 0.0, 0.8, 0.4],
]  # rad
path = spline_through(np.array(points), times=[0.0, 0.5, 1.0], ends="natural").pieces

motion = torque_limited(
    path,
    Limits(chain.joint_names, velocity=chain.velocity),
    partial(inverse_dynamics, chain),
    effort=chain.effort,
    friction=partial(friction_torque, chain),
)
print(f"{motion.duration:.3f} s")

at = motion.sample(np.linspace(0.0, motion.duration, 1000)[1:-1])
torque = inverse_dynamics(chain, at.position, at.velocity, at.acceleration)
torque += friction_torque(chain, at.velocity)
used = np.abs(torque) / chain.effort
for name, part in zip(chain.joint_names, used.T, strict=True):
    print(f"    {name:13} {100 * part.max():5.1f} % of its torque at most")
speed = np.abs(at.velocity) / chain.velocity
busy = np.mean(np.maximum(used, speed).max(axis=1) > 0.99)
print(f"some joint is at its torque or speed limit during {100 * busy:.0f} % of the time")
