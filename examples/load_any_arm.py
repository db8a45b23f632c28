"""Load an arm by name, from a URDF, and from a Denavit-Hartenberg table.

Run it with:  python examples/load_any_arm.py
"""

from math import pi

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.robots import chain_from_dh, load_robot

URDF = """
<robot name="pan_tilt">
  <link name="base"/> <link name="neck"/> <link name="head"/>
  <joint name="pan" type="revolute">
    <parent link="base"/> <child link="neck"/> <origin xyz="0 0 0.3"/> <axis xyz="0 0 1"/>
    <limit lower="-2.5" upper="2.5" velocity="2" effort="5"/>
  </joint>
  <joint name="tilt" type="revolute">
    <parent link="neck"/> <child link="head"/> <origin xyz="0 0 0.1"/> <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="2" effort="5"/>
  </joint>
</robot>
"""

arms = {
    "by name": load_robot("ur5e"),
    "URDF (text or path)": load_robot(URDF),
    "DH table": chain_from_dh(
        a=[0.0, 0.4, 0.3],
        b=[0.2, 0.0, 0.0],  # `d` in most other books
        alpha=[pi / 2, 0.0, 0.0],
        limits=[(-3.0, 3.0), (-1.5, 1.5), (-2.5, 2.5)],  # rad
    ),
}

for source, arm in arms.items():
    pose = forward_kinematics(arm, arm.midrange())
    print(f"{source}: {arm.n} joints from {arm.base} to {arm.tip}")
    print(f"    joints: {', '.join(arm.joint_names)}")
    print(f"    tip at mid-range: {pose[:3, 3].round(3)} m")
    print(f"    solver: {inverse_kinematics(arm, pose).family}")
