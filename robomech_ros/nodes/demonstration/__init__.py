"""Demonstrations of ``robomech demo``, with every part of the suite across processes.

A step that fails raises a DemoFailedError, whose text says which step and why.  Docstrings of this
package list the parameters of which there is more to say than their annotation does.
"""
