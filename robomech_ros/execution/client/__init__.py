"""The sender: gives trajectories to a controller and watches their execution."""
