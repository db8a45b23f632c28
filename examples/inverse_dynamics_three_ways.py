"""Compute the torques of a motion by Newton-Euler, Lagrange and the natural orthogonal complement.

Run it with:  python examples/inverse_dynamics_three_ways.py
"""

import numpy as np

from robomech_ros.dynamics import (
    inverse_dynamics,
    inverse_dynamics_by_lagrange,
    inverse_dynamics_by_orthogonal_complement,
    natural_orthogonal_complement,
)
from robomech_ros.robots import load_robot

chain = load_robot("puma560")
q, qd, qdd = np.random.default_rng(1).uniform(-1.0, 1.0, (3, 6))

# All of them leave out the friction of the drives; friction_torque(chain, qd) adds it.
torques = {
    "Newton-Euler": inverse_dynamics(chain, q, qd, qdd),
    "Lagrange": inverse_dynamics_by_lagrange(chain, q, qd, qdd),
    "orthogonal complement": inverse_dynamics_by_orthogonal_complement(chain, q, qd, qdd),
}
for name, torque in torques.items():
    print(f"{name:22} {torque.round(4)} N m")

first = torques["Newton-Euler"]
largest = max(np.abs(torque - first).max() for torque in torques.values())
print(f"largest difference: {largest:.0e} N m")

# Why the third way works: T, which maps joint rates to twists, annihilates the constraints K.
model = natural_orthogonal_complement(chain, q, qd)
print(f"K {model.K.shape} times T {model.T.shape}: at most {np.abs(model.K @ model.T).max():.0e}")
