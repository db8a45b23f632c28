"""The gripper of the simulated robot: its joints, and the actions that command it."""
