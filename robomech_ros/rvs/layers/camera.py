"""Initial view and "Fit view": the robot and its ghosts fill the picture."""

from typing import Any

import numpy as np

from robomech_ros.rvs.model.camera import visible_points
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.panel import GIZMO
from robomech_ros.rvs.page.surroundings import fit_camera, place_camera
from robomech_ros.typing import Array

# Between the joints and what is shown.
ORDER = 5.5
# Number of postures of a plan that must be in the picture.
SWEEP = 6


class CameraLayer(Layer):
    """The eye of every browser, which stays while the arm moves."""

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        place_camera(context.server, all_points(context))

    def controls(self, client: Any) -> Controls:
        """Return the button."""
        hint = "All that is shown of the robot fills the picture, seen from where you look now"
        button = client.gui.add_button("Fit view", hint=hint, order=ORDER)

        @button.on_click
        async def _(_: Any) -> None:
            self._context.ask("fit view", lambda: fit_view(self._context, client))

        return AllControls([button])


def fit_view(context: LayerContext, client: Any) -> None:
    """Fill a browser (viser.ClientHandle) with robot, ghosts, plan and layers."""
    fit_camera(client, all_points(context))


def all_points(context: LayerContext) -> Array:
    """Return points (k, 3) around everything shown, over the ground (m)."""
    extents = [extent() for extent in context.extents.values()]
    T = context.root_pose()
    return np.vstack([shown_points(context), *extents]) @ T[:3, :3].T + T[:3, 3]


def shown_points(context: LayerContext) -> Array:
    """Return points (k, 3) (m) in the root around the robot, its ghosts, a plan and the gizmo."""
    arm, seen = context.moved, context.seen
    postures = [arm.q, *(posture.q for posture in arm.study.postures)]
    if arm.study.nearest is not None:
        postures.append(arm.study.nearest)
    motion = context.plan.motion
    if motion is not None:
        postures += list(motion.at(np.linspace(motion.times[0], motion.times[-1], SWEEP)))
    points = visible_points(seen, [arm.positions_of(q) for q in postures])
    # The ends of the gizmo's arrows.
    T = seen.tree.link_poses(arm.positions)[arm.base] @ arm.target
    ends = arm.gizmo(GIZMO * seen.reach)["scale"] * T[:3, :3].T
    return np.vstack([points, T[:3, 3] + ends])
