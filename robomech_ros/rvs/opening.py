"""Opening a view, where viser is installed."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import RobotDescription, SerialChain
from robomech_ros.robots.robot_kinds import ARM, check_name, kind_of
from robomech_ros.rvs.kind_registry import PARALLEL, VIEW_KINDS
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.serving.address import HOST, PORT

if TYPE_CHECKING:
    from robomech_ros.collision import PlanningScene, SceneObject
    from robomech_ros.parallel import Mechanism, ParallelRobot
    from robomech_ros.rvs.model.draggable import DraggableRobot
    from robomech_ros.rvs.model.running.live_robot import LiveMobileRobot, LiveRobot
    from robomech_ros.rvs.model.running.observed_robot import ObservedRobot
    from robomech_ros.rvs.page.layer import LayerMaker
    from robomech_ros.rvs.page.page import RobotPage


class ViewUnavailableError(RobomechError):
    """viser is not installed."""

    def __init__(self) -> None:
        super().__init__("the view needs viser: pip install 'viser>=1.1.1,<1.2'")


def view(
    robot: str | os.PathLike[str],
    *,
    port: int = PORT,
    host: str = HOST,
    base: str | None = None,
    tip: str | None = None,
    scene: PlanningScene | Mapping[str, Any] | str | os.PathLike[str] | None = None,
) -> RobotPage:
    """Show a robot in a browser, to be moved by sliders, by its tip and from posture to posture.

    Parameters
    ----------
    robot : str or path
        Name, path or text of a robot, as for :func:`~robomech_ros.robots.load_robot`, of a
        parallel one, as for :func:`~robomech_ros.parallel.load_parallel`, of a rolling or walking
        one, as for :func:`~robomech_ros.rolling.load_rolling` and
        :func:`~robomech_ros.walking.load_legged`, which drives or walks on the page, or of a hand,
        as for :func:`~robomech_ros.hands.load_hand`, which holds an object there.
    port : int, optional
        To listen on; 0 takes a free one.
    host : str, optional
        Address to listen on; by default only this machine can reach it.
    base, tip : str, optional
        Links between which the arm is; by default those of ``load_robot``.  A parallel robot has
        its own.
    scene : PlanningScene, mapping or path, optional
        The objects around an arm: a scene of this arm, whose chain is then shown, or a scene in
        MoveIt's layout (see :meth:`~robomech_ros.collision.PlanningScene.load`).  The page changes
        a copy.

    Returns
    -------
    RobotPage
        Served until it is closed; ``url`` opens it, and contains the token that it asks for.

    Raises
    ------
    ViewUnavailableError
        viser is not installed.
    PortTakenError
        Another program listens on the port.
    AddressError
        The system does not let anybody listen at the address.
    BadValueError
        The port or the host is invalid, the robot has limbs of any kind, or the scene is of
        another arm.
    MissingLibraryError
        A scene is given, and coal is not installed.
    UnknownRobotError, UnknownLinkError, RobotDescriptionError
        As for ``load_robot``.

    See Also
    --------
    robomech_ros.kinematics.inverse_kinematics : the postures, without a picture.

    Examples
    --------
    >>> from robomech_ros.rvs import view
    >>> page = view("puma560", port=0)
    >>> page.url.split("=")[0].split("/")[-1]
    '?token'
    >>> page.close()
    """
    description, moved = shown_robot(robot)
    if scene is None:
        return page_of(description, moved or description.chain(base, tip), port=port, host=host)
    if moved is not None:
        raise BadValueError("scene", "given", f"none: '{moved.name}' is not an arm")
    around = _scene_of(description, base, tip, scene)
    return page_of(description, around.chain, port=port, host=host, scene=around)


def _scene_of(
    description: RobotDescription, base: str | None, tip: str | None, given: Any
) -> PlanningScene:
    from robomech_ros.collision import PlanningScene

    if not isinstance(given, PlanningScene):
        scene = PlanningScene(description, base=base, tip=tip)
        scene.load(given)
        return scene
    own = given.chain.description
    if own is None or own.name != description.name or base or tip:
        expected = f"a scene of '{description.name}', without another base or tip"
        raise BadValueError("scene", f"one of '{given.chain.name}'", expected)
    return given.copy()


def shown_robot(
    robot: str | os.PathLike[str], refuse: Callable[[str], None] = lambda kind: None
) -> tuple[RobotDescription, DraggableRobot | None]:
    """Load a robot to be shown; errors are those of :func:`view`.

    - ``refuse``: called with the kind of a robot that is no arm, before it is loaded; may raise.

    Returns the description, and what moves on the page; None of an arm, of which a chain is chosen.
    """
    check_name(robot, VIEW_KINDS)
    kind = kind_of(robot)
    view_kind = VIEW_KINDS.get(kind)
    if view_kind is not None and view_kind.loader:
        refuse(kind)
        require_viser()
        seen = view_kind.load(robot)
        return seen.description, seen
    described = load_tree_description(robot)
    if described.mechanism is None:
        return described.description, None
    refuse(PARALLEL)
    # Compiled code for parallel robots is loaded only for them.
    from robomech_ros.parallel import load_parallel

    return described.description, _platform(load_parallel(robot))


def page_of(
    description: RobotDescription,
    moved: SerialChain | DraggableRobot,
    *,
    port: int,
    host: str,
    live: Sequence[LayerMaker] = (),
    scene: PlanningScene | None = None,
) -> RobotPage:
    """Serve the page of a robot; other parameters and errors are those of :func:`view`.

    - ``moved``: the arm of it that moves on the page; or all of it.
    - ``live``: layers of a robot that runs, before the others; no other robot can then be shown.
    - ``scene``: the objects around the arm, which is the chain of the scene.
    """
    require_viser()
    from robomech_ros.rvs.layers.gripper import GripperLayer
    from robomech_ros.rvs.page.page import RobotPage

    layers, kind = [*live], ARM
    if not isinstance(moved, SerialChain):
        kind = moved.kind
    elif not live:
        layers.append(GripperLayer)
    if scene is not None:
        layers.append(_world_layer(scene=scene))
    layers += VIEW_KINDS[kind].make_layers()
    return RobotPage(description, moved, port=port, host=host, layers=layers, fixed=bool(live))


def live_page_of(
    description: RobotDescription,
    moved: SerialChain | ParallelRobot | Mechanism,
    robot: LiveRobot,
    *,
    port: int,
    host: str,
) -> RobotPage:
    """Serve the page of a robot that runs; parameters and errors are those of :func:`view`.

    - ``moved``: the arm of it that is commanded; or the whole of it, if it is parallel.
    - ``robot``: carries out what the page asks for, and tells it how the robot is.
    """
    require_viser()
    from robomech_ros.rvs.layers.gripper import GripperLayer
    from robomech_ros.rvs.layers.live import LiveLayer

    live: list[LayerMaker] = [partial(LiveLayer, robot=robot)]
    if isinstance(moved, SerialChain):
        live += [partial(GripperLayer, robot=robot), _world_layer(robot=robot)]
        return page_of(description, moved, port=port, host=host, live=live)
    return page_of(description, _platform(moved), port=port, host=host, live=live)


def mobile_page_of(
    followed: ObservedRobot, robot: LiveMobileRobot, *, port: int, host: str
) -> RobotPage:
    """Serve the page of a robot that runs over the ground; errors are those of :func:`view`.

    - ``robot``: carries out what the page asks for, and tells it how the robot is.
    """
    require_viser()
    from robomech_ros.rvs.layers.camera import CameraLayer
    from robomech_ros.rvs.layers.live_mobile_robot import LiveMobileRobotLayer
    from robomech_ros.rvs.page.page import RobotPage

    layers: list[LayerMaker] = [partial(LiveMobileRobotLayer, robot=robot), CameraLayer]
    description = followed.description
    return RobotPage(description, followed, port=port, host=host, layers=layers, fixed=True)


def _world_layer(**given: Any) -> LayerMaker:
    from robomech_ros.rvs.layers.world import WorldLayer

    return partial(WorldLayer, **given)


def _platform(robot: ParallelRobot | Mechanism) -> DraggableRobot:
    from robomech_ros.rvs.model.platforms.platform_view import PlatformView

    return PlatformView(robot)


def write_motion(
    path: str | os.PathLike[str],
    description: RobotDescription,
    motion: Motion,
    *,
    title: str = "",
    trail: str = "",
    scene: PlanningScene | None = None,
) -> Path:
    """Write a motion as a page that plays it, in one file that needs nothing else.

    The postures that were not taken are seen as ghosts.

    Parameters
    ----------
    path : str or path
        The file, as ``demo.html``.
    description : RobotDescription
    motion : Motion
        Motion of one of its chains, or of all of it.
    title : str, optional
        Above the page; default the name of the robot.
    trail : str, optional
        Link whose way is drawn; empty for none.
    scene : PlanningScene, optional
        Its objects are drawn where they are; links carry the attached ones.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ViewUnavailableError
        viser is not installed.
    UnknownLinkError, RobotDescriptionError
        The link of the trail is none of the robot, or no chain leads to it.
    BadValueError
        The scene has another base than the motion, or what moves is no arm.
    OSError
        The file cannot be written.
    """
    require_viser()
    from robomech_ros.rvs.page.recording import motion_page

    objects: Mapping[str, SceneObject] = {} if scene is None else scene.objects
    if scene is not None and scene.chain.base != motion.arm.base:
        expected = f"'{motion.arm.base}', the base of the motion"
        raise BadValueError("base of the scene", scene.chain.base, expected)
    page = motion_page(description, motion, title or description.name, trail=trail, objects=objects)
    Path(path).write_text(page, encoding="utf-8")
    return Path(path)


def require_viser() -> None:
    """Refuse to open a view where viser is not installed, by ViewUnavailableError."""
    if find_spec("viser") is None:
        raise ViewUnavailableError
