"""Put a gripper on an arm: a URDF of the library's Panda with Franka's hand.

Run it with:  python examples/add_a_gripper.py
Then:         robomech bringup --robot panda_with_hand.urdf --tip-link panda_hand_tcp
"""

from pathlib import Path

import numpy as np

from robomech_ros.robots import load_description

# Frames as in franka_description (franka_ros, Apache 2.0), limits as in MoveIt's Panda
# (moveit_resources, BSD): two slides, of which the second mimics the first.
HAND = """
  <link name="panda_hand"/> <link name="panda_hand_tcp"/>
  <link name="panda_leftfinger"/> <link name="panda_rightfinger"/>
  <joint name="panda_hand_joint" type="fixed">
    <parent link="panda_link8"/> <child link="panda_hand"/> <origin rpy="0 0 -0.785398163397"/>
  </joint>
  <joint name="panda_hand_tcp_joint" type="fixed">
    <parent link="panda_hand"/> <child link="panda_hand_tcp"/> <origin xyz="0 0 0.1034"/>
  </joint>
  <joint name="panda_finger_joint1" type="prismatic">
    <parent link="panda_hand"/> <child link="panda_leftfinger"/> <origin xyz="0 0 0.0584"/>
    <axis xyz="0 1 0"/> <limit lower="0" upper="0.04" velocity="0.2" effort="20"/>
  </joint>
  <joint name="panda_finger_joint2" type="prismatic">
    <parent link="panda_hand"/> <child link="panda_rightfinger"/> <origin xyz="0 0 0.0584"/>
    <axis xyz="0 -1 0"/> <limit lower="0" upper="0.04" velocity="0.2" effort="20"/>
    <mimic joint="panda_finger_joint1"/>
  </joint>
</robot>"""

urdf = load_description("panda").document.replace("</robot>", HAND)
Path("panda_with_hand.urdf").write_text(urdf, encoding="utf-8")

robot = load_description("panda_with_hand.urdf")
arm = robot.chain(tip="panda_hand_tcp")
print(f"the arm: {arm.n} joints from {arm.base} to {arm.tip}")
for name, follower in robot.followers.items():
    print(f"joint {name} follows {follower.leader}")
for position in (0.0, 0.02, 0.04):
    links = robot.link_poses({"panda_finger_joint1": position})
    between = links["panda_leftfinger"][:3, 3] - links["panda_rightfinger"][:3, 3]
    print(f"panda_finger_joint1 at {position} m: {np.linalg.norm(between):.3f} m wide")
