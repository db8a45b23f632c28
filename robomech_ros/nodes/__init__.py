"""The ROS 2 nodes and the ``robomech`` command; the only code of the package that imports ROS."""
