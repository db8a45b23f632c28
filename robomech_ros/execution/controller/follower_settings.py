"""Settings of a trajectory follower."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FollowerSettings:
    """Which trajectories are accepted, and how they are followed.

    Attributes
    ----------
    start_tolerance : float
        How far the first point may be from the present position, rad or m.
    longest_wait : float
        How far in the future a trajectory may begin, s.
    command_timeout : float
        How long after its end a trajectory may be under way, s; 0 = any time.
    interpolate : bool
        Whether the joints move from point to point; else each point is commanded at its time.
    max_acceleration_ratio : float
        How many times its acceleration limit a joint may accelerate on the curve through points
        with velocities; 0 = any.
    wait_for_stamp : bool
        Whether the present motion goes on until a later one begins; else that one replaces it when
        it comes, and its first point is reached at the time that its stamp gives.
    """

    start_tolerance: float = 0.01
    longest_wait: float = 3600.0
    command_timeout: float = 0.0
    interpolate: bool = True
    wait_for_stamp: bool = True
    max_acceleration_ratio: float = 5.0
