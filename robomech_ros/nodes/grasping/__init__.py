"""The node grasping."""
