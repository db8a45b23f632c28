"""The node trajectory_planner."""
