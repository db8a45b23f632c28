"""Contact wrenches, and closure and quality of grasps."""
