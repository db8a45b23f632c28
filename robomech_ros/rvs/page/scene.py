"""Scene of every browser: the robot, its ghosts, results for the pose."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from robomech_ros.rvs.model.bodies.visual_model import VisualModel
from robomech_ros.rvs.model.draggable import DraggableRobot
from robomech_ros.rvs.model.ghosts import PALETTE
from robomech_ros.rvs.page.ghost_nodes import Ghost, GhostNodes
from robomech_ros.rvs.page.node_space import NodeSpace, place_node, placed
from robomech_ros.rvs.page.robot_nodes import MARKED, RobotNodes
from robomech_ros.rvs.page.surroundings import add_surroundings
from robomech_ros.rvs.page.tables import notice, posture_table, summary
from robomech_ros.rvs.page.units import Units
from robomech_ros.spatial.poses import inverse_pose
from robomech_ros.typing import Array

# The node at the base of the arm, in which its poses are.
BASE = "/base"
NEAREST_COLOUR = (120, 120, 120)
# Colour of the goal of an arm that is elsewhere: red, green, blue and alpha.
GOAL_ROOT, GOAL_TINT = "/goal", (1.0, 0.55, 0.1, 0.4)


class PageScene:
    """The scene and the shared part of the panel.

    - ``moved``: the arm of it that is moved, or its platform.
    """

    def __init__(self, server: Any, seen: VisualModel, moved: DraggableRobot, units: Units) -> None:
        self._server, self._seen, self._units = server, seen, units
        # Pose of the root over the ground (m).
        self.root_pose = np.eye(4)
        scene, gui = server.scene, server.gui
        with server.atomic():
            # Beside the scene, not over it.
            gui.main_panel.dock_right()
            self._ground = add_surroundings(server, max(seen.reach, 0.5 * moved.room))
            self._robot = self._arm = RobotNodes(scene, seen)
            self._base_node = add_base(scene, seen, moved.base)
            self._to_root = inverse_pose(seen.tree.link_poses()[moved.base])
            self.ghosts = GhostNodes(NodeSpace(scene, BASE, seen.reach), moved.ghosts(seen))
            self._summary = units.html(gui, order=0)
            self._notice = units.html(gui, order=1)
            self._table = gui.add_html("", order=2)

    def show(self, arm: DraggableRobot, notices: Sequence[str]) -> None:
        """Show where an arm is, what is known of its pose, and what went wrong."""
        study, contacts = arm.study, arm.posture_contacts
        colours = [
            MARKED if contact else PALETTE[k % len(PALETTE)] for k, contact in enumerate(contacts)
        ]
        ghosts = [
            Ghost(number, posture.q, colours[number], bool(contacts[number]))
            for number, posture in enumerate(study.postures)
            if not posture.is_here
        ]
        if study.nearest is not None:
            ghosts = [Ghost(0, study.nearest, NEAREST_COLOUR)]
        with self._server.atomic():
            self._arm.move(arm.positions)
            self._arm.mark(arm.faulty_links)
            self.ghosts.show(ghosts)
            self._summary.content = summary(arm)
            self._notice.content = notice([*self._seen.missing, *notices])
            self._table.content = posture_table(
                study.postures, colours, contacts, arm.units, self._units
            )

    def separate(self) -> tuple[RobotNodes, RobotNodes]:
        """Draw the arm as a goal, translucent, beside the robot, which the caller moves.

        The goal is to be shown or hidden by the caller, and is moved here.
        """
        with self._server.atomic():
            self._arm = RobotNodes(self._server.scene, self._seen, GOAL_ROOT, GOAL_TINT)
        return self._robot, self._arm

    def move_base(self, T: Array) -> None:
        """Put the base of the arm, with all that is drawn in it, at a pose (4, 4) (m)."""
        self.root_pose = root = T @ self._to_root
        nodes = (self._robot.node, root), (self._arm.node, root), (self._base_node, T)
        with self._server.atomic():
            for node, pose in nodes:
                place_node(node, pose)

    def fade(self, faded: bool) -> None:
        """Draw the robot translucent, or as it is."""
        self._robot.fade(faded)

    def path(self, link: str) -> str:
        """Return the name of the node of a link of the robot."""
        return self._robot.path(link)

    def switch(self, what: str, shown: bool) -> None:
        """Show a part of the scene, or not."""
        if what == "ghosts":
            self.ghosts.want(shown)
        elif what == "frames":
            self._robot.show_frames(shown)
        elif what == "joint axes":
            self._robot.show_axes(shown)
        elif what == "ground":
            self._ground.visible = shown


def add_base(scene: Any, seen: VisualModel, base: str) -> Any:
    """Add the node (viser.FrameHandle) at the base of an arm, a link."""
    return scene.add_frame(BASE, show_axes=False, **placed(seen.tree.link_poses()[base]))
