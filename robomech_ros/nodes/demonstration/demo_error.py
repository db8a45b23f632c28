"""The one way in which a demonstration fails."""

from robomech_ros.errors import RobomechError


class DemoFailedError(RobomechError):
    """A step of the demonstration went wrong; the text says which and why."""
