"""Find every joint vector that reaches a pose, or the reason why there is none.

Run it with:  python examples/all_solutions.py
"""

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.robots import load_robot

chain = load_robot("puma560")
seed = [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]  # rad
target = forward_kinematics(chain, seed)

result = inverse_kinematics(chain, target, seed=seed)
print(f"{len(result.q)} solutions (family {result.family}), provably all: {result.complete}")
for q, branch in zip(result.q, result.branches, strict=True):
    print(f"    {q.round(3)}  {branch}")

print("without joint limits:", len(inverse_kinematics(chain, target, respect_limits=False).q))

# Three poses that cannot be reached, each for another reason.
far = target.copy()
far[:3, 3] *= 5.0

wrist_bent = forward_kinematics(chain, [0.0, 0.5, -1.2, 0.0, 1.9, 0.0])  # beyond its limit

scara = load_robot("scara")  # four joints: its tool always points down
tilted = forward_kinematics(scara, [0.3, 0.4, -0.1, 0.0])
tilted[:3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]

for arm, pose in ((chain, far), (chain, wrist_bent), (scara, tilted)):
    answer = inverse_kinematics(arm, pose)
    print(f"{arm.name}: {answer.status.name}: {answer.reason}")
