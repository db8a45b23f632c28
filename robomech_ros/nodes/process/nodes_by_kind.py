"""Robots that are no arms: their nodes, what of bringup does not concern them, their demonstration.

Arms and parallel robots share the other nodes.  A new kind takes a row here, one in
:data:`robomech_ros.robots.robot_kinds.KINDS`, and one in the table of ``robomech robots``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pkgutil import resolve_name

from robomech_ros.rolling import rolling_robot


@dataclass(frozen=True, kw_only=True)
class NodesOfKind:
    """Nodes for robots of one kind."""

    kind_name: str  #: Name of the kind, for messages.
    nodes: tuple[str, ...]  #: Names of its nodes, in the order in which they are started.
    #: Loads a robot by name or path, and raises a ``RobomechError`` where that cannot be.
    load: Callable[[str], object]
    refused: tuple[str, ...]  #: Options of bringup that such robots have no use for.
    #: The node that publishes ``joint_states``, with the parameters ``publish_rate`` and
    #: ``simulation``; empty for none.
    simulator: str = ""
    frame_prefix: str = "frame_prefix"  #: The parameter with what names of frames begin with.
    #: Names the variant of a robot by name or path, such as its drive: its nodes also get the
    #: parameters in ``config/<node>.<variant>.yaml``, if there is such a file.
    variant: Callable[[str], str] | None = None
    #: The module of the demonstration, with ``demonstrate(robot, output)``; empty for none.
    demonstration: str = ""


# Options for arms only.
_OF_ARMS = (
    *("joint_limits", "srdf", "group", "base_link", "tip_link", "calibration", "auto_execute"),
    "move_group",
)


def _loader(function: str) -> Callable[[str], object]:
    # Kernels of a kind are loaded only for a robot of that kind.
    return lambda robot: resolve_name(f"robomech_ros.{function}")(robot)


KIND_NODES = {
    "rolling": NodesOfKind(
        kind_name="rolling robot",
        nodes=("mobile_base",),
        simulator="mobile_base",
        load=rolling_robot,
        refused=_OF_ARMS,
        frame_prefix="tf_frame_prefix",
        variant=lambda robot: rolling_robot(robot).drive,
        demonstration="robomech_ros.nodes.demonstration.rolling_session",
    ),
    "hand": NodesOfKind(
        kind_name="hand",
        nodes=("grasping",),
        load=_loader("hands:load_hand"),
        refused=(*_OF_ARMS, "rate", "dynamic", "view", "view_port", "view_host"),
    ),
    "walking": NodesOfKind(
        kind_name="walking machine",
        nodes=("joint_trajectory_controller", "walker"),
        simulator="joint_trajectory_controller",
        load=_loader("walking:load_legged"),
        refused=(*_OF_ARMS, "dynamic"),
        demonstration="robomech_ros.nodes.demonstration.walk_session",
    ),
}

# Options of bringup that parallel robots and each of these kinds reject.
REFUSED = {
    "parallel robots": ("joint_limits", "srdf", "group", "move_group"),
    **{f"{one.kind_name}s": one.refused for one in KIND_NODES.values()},
}
