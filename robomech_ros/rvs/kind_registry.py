"""One description of each kind of robot on a page: its loader, and its layers."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pkgutil import resolve_name
from typing import TYPE_CHECKING, NamedTuple

from robomech_ros.robots.robot_kinds import ARM

if TYPE_CHECKING:
    from robomech_ros.rvs.model.kinds.tree_view import TreeView
    from robomech_ros.rvs.page.layer import LayerMaker

PARALLEL = "parallel"


class ViewKind(NamedTuple):
    """Display of robots of a kind."""

    #: Modules and classes in ``rvs.layers``, in the order of their folders on the page.
    layers: tuple[str, ...]
    #: Module and function that loads a robot, and module and class in ``rvs.model`` of a
    #: :class:`TreeView` of it; none for arms and parallel robots.
    loader: str = ""
    view: str = ""

    def load(self, robot: str | os.PathLike[str]) -> TreeView:
        """Load a robot by name, path or text; errors are those of loader and view."""
        loaded = resolve_name(f"robomech_ros.{self.loader}")(robot)
        return resolve_name(f"robomech_ros.rvs.model.{self.view}")(loaded)

    def make_layers(self) -> list[LayerMaker]:
        """Return the layers; what is compiled for a kind is loaded here, where there is one."""
        return [resolve_name(f"robomech_ros.rvs.layers.{name}") for name in self.layers]


VIEW_KINDS: Mapping[str, ViewKind] = {
    ARM: ViewKind((
        "camera:CameraLayer",
        "analysis:AnalysisLayer",
        "dh_table:DHTableLayer",
        "workspace:WorkspaceLayer",
        "contours:ContoursLayer",
        "motions:MotionLayer",
        "recording:RecordingLayer",
    )),
    PARALLEL: ViewKind((
        "platform:PlatformLayer",
        "platform_workspace:PlatformWorkspaceLayer",
        "platform_contours:PlatformContoursLayer",
        "motions:MotionLayer",
        "camera:CameraLayer",
    )),
    "rolling": ViewKind(
        ("mobile_robot:MobileRobotLayer", "camera:CameraLayer"),
        "rolling:rolling_robot", "kinds.rolling:BaseView",
    ),
    "walking": ViewKind(
        ("mobile_robot:MobileRobotLayer", "walking:WalkingLayer", "camera:CameraLayer"),
        "walking:load_legged", "walking.walker_view:WalkerView",
    ),
    "hand": ViewKind(
        ("hands:HandLayer", "camera:CameraLayer"), "hands:load_hand", "hands.hand_view:HandView"
    ),
}  # fmt: skip
