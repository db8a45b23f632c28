"""Subcommands of ``robomech`` that use ROS; they import it when they run, not before."""
