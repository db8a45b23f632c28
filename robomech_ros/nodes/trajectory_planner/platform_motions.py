"""Motions of parallel robots: trajectories hold the drives, all other joints follow."""

from typing import Any

import numpy as np
from sensor_msgs.msg import JointState

from robomech_ros.cartesian import CartesianPlan
from robomech_ros.nodes.common.joints.joint_positions import JointPositions
from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.nodes.common.messages.joint_messages import positions_by_name
from robomech_ros.nodes.trajectory_planner.chain_motions import Planned
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Mechanism, follow_drives, plan_drives, plan_platform
from robomech_ros.trajectory import Limits, PosePath
from robomech_ros.typing import Array

# Joints that differ by more (rad or m) are another posture for the same drives.
_SAME = 1e-4


class PlatformMotions:
    """Plans motions of a parallel robot of n joints and m drives.

    - ``joints``: reads requests, and knows the present posture.
    """

    def __init__(self, mechanism: Mechanism, joints: JointPositions) -> None:
        self.way, self._all = mechanism, Limits.of(mechanism)
        self.limits = self._all.only(mechanism.drive_index.tolist())
        self._joints = joints

    def commanded(self, q: Array) -> Array:
        """Pick the drives, shape (m,), of a posture, shape (n,)."""
        return q[self.way.drive_index]

    def read_goal(self, state: JointState) -> tuple[Array, Array | None]:
        """Read the goal of the drives, and of all joints where it gives them."""
        assert self._joints.loops is not None
        if self._joints.loops.gives_drives(state):
            return positions_by_name(state, self.way.actuated, "goal"), None
        q = self._joints.read(self.way, state, "goal")
        return self.commanded(q), q

    def check_start(self, q: Array) -> None:
        """Refuse a start (n,) in another assembly mode than that of the present posture."""
        present = self._joints.present_posture()
        if present is None:
            return
        there = self.way.close(self.commanded(q), present)
        if there.status is Code.NONE:
            self._require_same("start", q, there.q, "in which the robot is")

    def _require_same(self, what: str, given: Array, found: Array, mode: str) -> None:
        """Refuse a posture (n,) in another assembly mode than the one found for its drives."""
        turns = np.array(self.way.units) == "rad"
        off = given - found
        off = np.where(turns, np.remainder(off + np.pi, 2.0 * np.pi) - np.pi, off)
        if np.abs(off).max() <= _SAME:
            return
        here, there = (self.way.pose(q)[:3, 3] for q in (given, found))
        text = (
            f"{what} is in another assembly mode than the one {mode}: with these drives the "
            f"platform is there at {_listed(there)} m, not at {_listed(here)} m, or turned "
            "otherwise; only a singularity leads from one to the other"
        )
        raise OutcomeError(Code.JUMP, text)

    def tip_pose(self, q: Array) -> Array:
        """Pose of the platform in the base (4, 4)."""
        return self.way.pose(q)

    def through(
        self, points: Array, start: Array, goal: Array | None, options: dict[str, Any]
    ) -> Planned:
        """Plan through points of the drives (k, m), in the assembly mode of the start.

        Raises OutcomeError: a singularity or the limit of a passive joint is on the way, or the
        goal is in another assembly mode.
        """
        plan = plan_drives(self.way, points, start, limits=self._all, **options)
        times, way = plan.sampled.waypoints.times, plan.way
        if way.stop is not None:
            text = (
                f"the motion would have to stop before point {way.stop} of {len(times)}, "
                f"{times[max(way.stop - 1, 0)]:.3g} s of {times[-1]:.3g} s after its start: "
                f"{way.reason}"
            )
            raise OutcomeError(way.status, text)
        if goal is not None:
            self._require_same("goal", goal, way.q[-1], "in which the motion ends")
        return Planned(plan.sampled, lambda: self.way.pose(way.q))

    def along(
        self, path: PosePath, start: Array, kept: float, options: dict[str, Any]
    ) -> CartesianPlan:
        """Plan along a path of the platform within a part of the limits of rates."""
        limits = self._all.scaled(velocity=kept, acceleration=kept, jerk=kept)
        return plan_platform(self.way, path, start, limits=limits, **options)

    def poses_along(self, plan: CartesianPlan) -> Array:
        """Find the poses (k, 4, 4) of the platform at the samples of a plan."""
        assert plan.samples is not None
        found = follow_drives(self.way, plan.samples.positions, plan.followed.start)
        return self.way.pose(found.q)

    def warm_up(self) -> None:
        """Load what follows and judges postures."""
        home = self.way.home()
        follow_drives(self.way, self.commanded(home)[None], home)


def _listed(values: Array) -> str:
    return " ".join(f"{round(value, 4) + 0.0:g}" for value in values)
