"""Services of MoveIt under the names of the nodes."""
