"""The robot of a node: description, SRDF, gripper and floating base."""
