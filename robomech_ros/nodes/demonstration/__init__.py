"""Demonstrations of ``robomech demo``, with every part of the suite across processes.

A step that fails raises a DemoFailedError, whose text says which step and why. In all modules
``client`` is connected to the running nodes, ``which`` or ``robot`` says what moves, by name or
path, and plots and pages go to the folder ``output``.
"""
