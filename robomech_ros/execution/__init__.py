"""Execution of trajectories: checks, smooth joining and stopping, and the state machine."""
