"""How large the parts of a request may be."""

from robomech_ros.errors import WrongSizeError


def check_waypoints(what: str, count: int, most: int) -> None:
    """Refuse more points to go through than can be planned in some seconds."""
    if count > most:
        raise WrongSizeError(what, count, f"at most {most}, the parameter max_waypoints")
