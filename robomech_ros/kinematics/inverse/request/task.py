"""Components of a pose that a solution has to meet."""

# x, y, z, rx, ry, rz, along and about the axes of the target.
Task = tuple[bool, bool, bool, bool, bool, bool]
FULL_TASK: Task = (True, True, True, True, True, True)
