"""Names of parallel robots, found without compiling anything."""

from robomech_ros.robots.robot_kinds import names_of


def list_parallel() -> tuple[str, ...]:
    """List the names of the parallel robots in all folders, sorted.

    Examples
    --------
    >>> from robomech_ros.parallel import list_parallel
    >>> "delta" in list_parallel()
    True
    """
    return names_of("parallel")
