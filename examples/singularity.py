"""Ask how near a posture is to a singularity, which motions are lost there, and why.

Run it with:  python examples/singularity.py
"""

from robomech_ros.kinetostatics import (
    characteristic_length,
    nearest_singular_posture,
    singularity_report,
)
from robomech_ros.robots import load_robot

chain = load_robot("puma560")
length = characteristic_length(chain)
print(f"{chain.name}: characteristic length {length:.3f} m")

for name, q in (
    ("regular", [0.1, -0.5, 0.4, 0.3, 0.8, 0.2]),
    ("wrist straight", [0.1, -0.5, 0.4, 0.3, 0.0, 0.2]),
):
    report = singularity_report(chain, q, length=length)
    condition = report.normalised_condition_number
    print(f"{name}: rank {report.rank}, condition number {condition:.4g}, {report.kinds or 'none'}")
    for part, factor in report.factors.items():
        print(f"    {part}: {factor:.3g}")
    for twist in report.lost_directions:
        print(f"    lost: angular {twist[:3].round(2)}, linear {twist[3:].round(2)}")
    for rates in report.self_motions:
        print(f"    the tip rests while the joints move by {rates.round(2)}")

near = nearest_singular_posture(chain, [0.1, -0.5, 0.4, 0.3, 0.8, 0.2])
print(f"nearest singular posture: {near.q.round(3)}, {near.distance:.3f} rad away")
