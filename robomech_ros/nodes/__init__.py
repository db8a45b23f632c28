"""The ROS 2 nodes and the ``robomech`` command; the only code of the package that imports ROS.

Parts of nodes get some arguments under the same names everywhere: the ``node`` owns their topics,
services, timers and log lines; ``settings``, if it is a callable, returns the parameters as they
are now; the ``clock`` has the time of motions; the ``monitor`` knows the joint states of the robot;
``joints`` reads positions from messages; the ``worker`` does long work while the node serves
others; ``scenes`` and ``collisions`` know what the robot may touch; the ``controller`` is a name.
"""
