"""The node kinematics."""
