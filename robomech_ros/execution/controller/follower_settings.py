"""Settings of a trajectory follower."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FollowerSettings:
    """Acceptance of trajectories, and their execution (rad or m, and s).

    The first point may be ``start_tolerance`` from the present position. A trajectory may begin
    ``longest_wait`` in the future, and be under way ``command_timeout`` after its end; 0 = any
    time. Joints move from point to point if they ``interpolate``; else each point is commanded at
    its time. On the curve through points with velocities a joint may accelerate
    ``max_acceleration_ratio`` times its limit; 0 = any. With ``wait_for_stamp`` the present motion
    goes on until a later one begins; else that one replaces it when it comes, and its first point
    is reached at the time of its stamp.
    """

    start_tolerance: float = 0.01
    longest_wait: float = 3600.0
    command_timeout: float = 0.0
    interpolate: bool = True
    wait_for_stamp: bool = True
    max_acceleration_ratio: float = 5.0
