"""Parts of the node trajectory_publisher."""
