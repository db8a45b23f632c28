"""The node with MoveIt's services, actions and topics, and the planning scene."""
