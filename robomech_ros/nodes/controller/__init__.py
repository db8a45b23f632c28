"""Parts of the node joint_trajectory_controller, the simulated robot."""
