"""The node joint_trajectory_controller, the simulated robot."""
