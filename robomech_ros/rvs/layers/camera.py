"""Where the eye is, at first and by a button: the robot and its ghosts fill the picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomech_ros.rvs.model.eye import seen_points
from robomech_ros.rvs.page.audience import AllControls, Controls
from robomech_ros.rvs.page.layer import Place
from robomech_ros.rvs.page.panel import GIZMO
from robomech_ros.rvs.page.surroundings import fit_eye, place_eye

__all__ = ["CameraLayer"]

# Between the joints and what is shown.
ORDER = 5.5
# Of a plan so many postures are to be in the picture.
SWEEP = 6


class CameraLayer:
    """The eye of every browser.

    Parameters
    ----------
    place : Place
    """

    def __init__(self, place: Place) -> None:
        self._place = place
        place_eye(place.server, self._points())

    def show(self) -> None:
        """Do nothing: the eye stays while the arm moves."""

    def controls(self, client: Any) -> Controls:
        """Give the button."""
        hint = "Robot, ghosts and plan fill the picture, seen from where you look now"
        button = client.gui.add_button("Fit view", hint=hint, order=ORDER)

        @button.on_click
        async def _(_: Any) -> None:
            self._place.ask("fit view", lambda: fit_eye(client, self._points()))

        return AllControls([button])

    def close(self) -> None:
        """Do nothing: nothing runs."""

    def _points(self) -> NDArray[np.float64]:
        arm, seen = self._place.moved, self._place.seen
        postures = [arm.q, *(posture.q for posture in arm.study.postures)]
        if arm.study.nearest is not None:
            postures.append(arm.study.nearest)
        motion = self._place.plan.motion
        if motion is not None:
            postures += list(motion.at(np.linspace(motion.times[0], motion.times[-1], SWEEP)))
        points = seen_points(seen, [arm.positions_of(q) for q in postures])
        # The arrows of the gizmo, both ways.
        T = seen.tree.link_poses()[arm.base] @ arm.target
        ends = GIZMO * seen.reach * np.vstack([T[:3, :3].T, -T[:3, :3].T])
        room = 0.5 * arm.room * np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
        return np.vstack([points, T[:3, 3] + ends, T[:3, 3] + room, T[:3, 3] - room])
