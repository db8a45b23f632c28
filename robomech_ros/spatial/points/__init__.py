"""The motion of a rigid body from that of its points."""
