"""Which components of a pose a solution has to meet."""

__all__ = ["FULL_TASK", "Task"]

# x, y, z, rx, ry, rz, along and about the axes of the target.
Task = tuple[bool, bool, bool, bool, bool, bool]
FULL_TASK: Task = (True, True, True, True, True, True)
