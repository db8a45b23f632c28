"""Kinematics, kinetostatics, trajectories and dynamics of robotic mechanical systems.

Importing this package costs nothing and pulls in neither ROS nor numba; import what is needed
from its parts, for example ``from robomech_ros.robots import load_robot``.
"""

__version__ = "0.1.0"
