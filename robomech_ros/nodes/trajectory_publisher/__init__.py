"""The node trajectory_publisher."""
