"""A plan in the scene: a sweep of ghosts, the ghost at one time, and traces of frames."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from robomech_ros.kinematics import link_poses
from robomech_ros.parallel import Mechanism
from robomech_ros.rvs.model.ghosts import PALETTE, mixed
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.page.ghost_nodes import GhostBatch
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.spatial import quaternion_from_matrix
from robomech_ros.typing import Array

# Ghosts of a sweep, from the colour of the start to that of the goal, and the one at the time.
SWEEP = 12
START_COLOUR, GOAL_COLOUR, NOW_COLOUR = (40, 140, 90), (190, 60, 150), (245, 130, 30)
SWEEP_OPACITY, NOW_OPACITY = 0.16, 0.9
# How slim they are: within the other ghosts, and around them.
SWEEP_SLIMNESS, NOW_SLIMNESS = 0.74, 0.86
# Points of a trace; its width and the axes along it, in reaches of the robot.
TRACE = 200
TRACE_WIDTH, AXES_LENGTH, AXES_RADIUS = 0.006, 0.05, 0.0025


class SweptPlan(NamedTuple):
    """Shown parts of a plan."""

    motion: Motion
    #: Postures at even times (rad or m), shape (k, n).
    sweep: Array
    #: Poses of each link in the base at even times (m), shape (m, 4, 4).
    traces: dict[str, Array]


def swept(motion: Motion) -> SweptPlan:
    """Prepare what of a plan is seen at once."""
    robot, first, last = motion.chain, motion.times[0], motion.times[-1]
    along = motion.at(np.linspace(first, last, TRACE))
    sweep = motion.at(np.linspace(first, last, SWEEP))
    if isinstance(robot, Mechanism):
        return SweptPlan(motion, sweep, {robot.platform_link: robot.pose(along)})
    links = motion.arm.links
    poses = link_poses(motion.arm, along, links)
    return SweptPlan(motion, sweep, {link: poses[:, k] for k, link in enumerate(links)})


class MotionScene:
    """The nodes of a plan, which all browsers see."""

    def __init__(self, context: LayerContext) -> None:
        self._space = context.space._replace(base=f"{context.base}/plan")
        scene, root = self._space.scene, self._space.base
        scene.add_frame(root, show_axes=False)
        styles = {"sweep": (SWEEP_SLIMNESS, SWEEP_OPACITY), "now": (NOW_SLIMNESS, NOW_OPACITY)}
        self._sweep, self._now = (
            GhostBatch(
                scene, f"{root}/{name}", context.moved.ghosts(context.seen, radius_scale), opacity
            )
            for name, (radius_scale, opacity) in styles.items()
        )
        self._lines: list[Any] = []

    def show(self, plan: SweptPlan | None, sweep: bool, traced: Iterable[str]) -> None:
        """Show a plan, or none: its sweep if wanted, and the traces of these links."""
        self._sweep.node.visible = plan is not None and sweep
        self._now.node.visible = plan is not None
        for line in self._lines:
            line.remove()
        self._lines = []
        if plan is None:
            return
        parts = np.linspace(0.0, 1.0, len(plan.sweep))
        self._sweep.place(
            list(plan.sweep), [mixed(START_COLOUR, GOAL_COLOUR, part) for part in parts]
        )
        for number, link in enumerate(traced):
            self._trace(number, plan.traces[link])

    def go_to(self, q: Array) -> None:
        """Put the ghost at the time into its posture (n,), rad or m."""
        self._now.place([q], [NOW_COLOUR])

    def _trace(self, number: int, poses: Array) -> None:
        points = poses[:, :3, 3]
        if float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) > 1e-6:
            ends, colour = (
                np.stack([points[:-1], points[1:]], axis=1),
                PALETTE[number % len(PALETTE)],
            )
            line = self._space.add_lines(f"trace_{number}", ends, colour, TRACE_WIDTH)
            self._lines.append(line)
        at = poses[np.linspace(0, len(poses) - 1, SWEEP).astype(np.int64)]
        self._lines.append(
            self._space.scene.add_batched_axes(
                f"{self._space.base}/axes_{number}",
                np.roll(quaternion_from_matrix(at[:, :3, :3]), 1, axis=-1),
                at[:, :3, 3],
                axes_length=AXES_LENGTH * self._space.reach,
                axes_radius=AXES_RADIUS * self._space.reach,
            )
        )
