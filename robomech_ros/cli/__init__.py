"""The ``robomech`` command, and those of its subcommands that need no ROS."""
