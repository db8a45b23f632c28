"""Pass through points without a stop: splines at given times, or as fast as the limits allow.

Run it with:  python examples/spline_through_points.py
"""

import numpy as np

from robomech_ros.robots import load_robot
from robomech_ros.trajectory import spline_through, through_points, verify

chain = load_robot("puma560")
points = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.3, -0.2, 0.5, 0.2, 0.1, 0.0],
        [0.6, 0.1, 0.2, 0.4, 0.5, 0.1],
        [0.5, -0.3, 0.4, 0.0, 0.6, 0.2],
    ]
)  # rad

times = [0.0, 1.0, 1.8, 3.0]  # s
spline = spline_through(points, times=times, ends="rest")
for t in times:
    at = spline.sample(t)
    print(f"t = {t:.1f} s: q = {at.position.round(3)}, q[0] moves at {at.velocity[0]:+.3f} rad/s")

for profile in ("cubic_spline", "ruckig", "time_optimal"):
    motion = through_points(points, limits=chain, profile=profile)
    within = verify(motion, chain).ok
    print(f"{profile}: {motion.duration:.3f} s, passes at {motion.knots.round(3)} s, ok: {within}")
