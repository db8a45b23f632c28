"""Go from one posture to another with every motion profile, and compare them.

Run it with:  python examples/profiles.py
"""

import numpy as np

from robomech_ros.robots import load_robot
from robomech_ros.trajectory import PROFILES, point_to_point, verify

chain = load_robot("puma560")
start, goal = np.zeros(6), [0.5, -0.3, 0.4, 0.0, 0.6, 0.2]  # rad

print("profile        time (s)   peak, in parts of the limit")
print("                          velocity  acceleration  jerk")
for profile in PROFILES:
    motion = point_to_point(start, goal, limits=chain, profile=profile)
    check = verify(motion, chain)  # the whole curve, not only samples
    peaks = (check.peak_velocity_ratio, check.peak_acceleration_ratio, check.peak_jerk_ratio)
    shown = "  ".join(f"{np.nanmax(peak):10.3f}" for peak in peaks)
    print(f"{profile:14} {motion.duration:8.3f} {shown}")

motion = point_to_point(start, goal, limits=chain, profile="poly345", duration=1.5)
for t in np.linspace(0.0, motion.duration, 4):
    at = motion.sample(t)
    print(f"t = {t:.1f} s: q[0] = {at.position[0]:.3f} rad, {at.velocity[0]:.3f} rad/s")
