"""Interface of a page's layer: an addition to the robot and its postures."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any, NamedTuple, Protocol, TypeVar

from robomech_ros.robots import RobotDescription, SerialChain
from robomech_ros.rvs.model.arms.arm import ArmView
from robomech_ros.rvs.model.bodies.visual_model import VisualModel
from robomech_ros.rvs.model.draggable import DraggableRobot
from robomech_ros.rvs.model.platforms.platform_view import PlatformView
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.page.clients import Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.node_space import NodeSpace
from robomech_ros.rvs.page.robot_nodes import RobotNodes
from robomech_ros.rvs.page.tables import fact_table
from robomech_ros.rvs.page.units import Units
from robomech_ros.rvs.serving.ticker import Ticker
from robomech_ros.rvs.serving.worker import Worker
from robomech_ros.typing import Array

Robot = TypeVar("Robot", bound=DraggableRobot)


class Ask(Protocol):
    """Runs requests on the thread of the page, and shows their results."""

    def __call__(self, kind: Hashable, request: Callable[[], None], source: object = None) -> None:
        """Ask; returns at once.

        - ``kind``: kind of the request; only the latest waiting request of a kind is done.
        - ``request``: what is to be done; it may move the arm.  If it raises a ``RobomechError``,
          the page shows a notice and nothing moves.
        - ``source``: the control that asked; the page does not write the new value back to it.
        """


class Switch(NamedTuple):
    """A part of a layer that can be shown or hidden; the address of the page keeps which.

    - ``is_on``: returns whether the part is shown.
    - ``turn``: shows or hides the part, and marks that in the controls.
    """

    is_on: Callable[[], bool]
    turn: Callable[[bool], None]


class PlanView:
    """The plan that a page shows, or none; not for several threads at a time.

    - ``name``: name of the plan on the page.
    """

    def __init__(self) -> None:
        self.motion: Motion | None = None
        self.name = ""

    def show(self, motion: Motion | None, name: str) -> None:
        """Show a motion instead of the present one."""
        self.motion, self.name = motion, name

    def forget(self) -> None:
        """Show none."""
        self.show(None, "")


@dataclass(frozen=True)
class LayerContext:
    """Context of a layer.

    - ``switched``: returns the parts by name, and whether the commanding browser shows them.
    - ``switch``: shows or hides the part of a name.
    - ``ask``: has a request done, see :class:`Ask`.
    """

    #: Nodes and texts that all browsers see, viser.ViserServer.
    server: Any
    #: The robot as it is drawn.
    seen: VisualModel
    #: The arm, or the parallel robot: to be read and moved in requests and in :meth:`Layer.show`
    #: alone.
    moved: DraggableRobot
    #: Node at the base of the arm, in which its poses are.
    base: str
    ask: Ask
    #: The plan that is shown; to be read and changed where the arm is.
    plan: PlanView
    description: RobotDescription
    #: Shows another robot and its arm on the same page; in requests alone.  Stage, layers and
    #: controls are made anew.  Raises a ``RobomechError`` where that robot cannot be shown, and
    #: leaves this one.
    replace: Callable[[RobotDescription, SerialChain], None]
    #: Has a request done as ``ask`` does; the request itself shows its result.
    run: Callable[[Hashable, Callable[[], None]], None]
    switched: Callable[[], dict[str, bool]]
    switch: Callable[[str, bool], None]
    #: Switches that layers offer, by their names on the page.
    offered: dict[str, Switch]
    #: Values that layers save for the layers of the next robot, by name.
    saved_values: dict[str, Any]
    #: Hides ghosts and gizmo for a while, or shows those again that are switched on; in requests
    #: alone.
    reveal: Callable[[bool], None]
    #: Draws the arm as a translucent goal beside the robot.  Returns the nodes of the robot, which
    #: the caller moves from then on, and those of the goal.
    separate: Callable[[], tuple[RobotNodes, RobotNodes]]
    #: Draws the robot translucent, or in its own colours.
    fade: Callable[[bool], None]
    #: Returns the name of the node of a link.
    path: Callable[[str], str]
    #: Puts the base of the arm at a pose (4, 4) over the ground (m), on any thread.
    move_base: Callable[[Array], None]
    #: Returns the pose (4, 4) of the root over the ground (m).
    root_pose: Callable[[], Array]
    #: The units of angles on the page.
    units: Units
    #: Callables of layers; each returns points (k, 3) in the root (m) that the picture must show.
    extents: dict[str, Callable[[], Array]] = field(default_factory=dict)
    #: Callables of layers that receive the joint positions of a running robot by name (rad or m),
    #: on any thread.
    followers: list[Callable[[Mapping[str, float]], None]] = field(default_factory=list)

    def robot_of(self, kind: type[Robot]) -> Robot:
        """Return the robot that is moved; raise a TypeError if it is of another class."""
        if not isinstance(self.moved, kind):
            raise TypeError(f"the page shows a {type(self.moved).__name__}, no {kind.__name__}")
        return self.moved

    @property
    def space(self) -> NodeSpace:
        """Space of the nodes that move with the base of the arm."""
        return NodeSpace(self.server.scene, self.base, self.seen.reach)

    @property
    def arm(self) -> ArmView:
        """Arm that is moved."""
        return self.robot_of(ArmView)

    @property
    def jogged(self) -> SerialChain | None:
        """The arm that can be jogged; None of a parallel robot."""
        return self.moved.chain if isinstance(self.moved, ArmView) else None

    @property
    def platform(self) -> PlatformView:
        """Parallel robot that is moved."""
        return self.robot_of(PlatformView)

    @property
    def chain(self) -> SerialChain:
        """The arm that is moved."""
        return self.arm.chain


class Layer:
    """A part of a page; all methods are called on its thread, ``show`` inside one update.

    - ``label``, ``order``, ``expanded``: name of the layer's folder of controls, its position among
      the folders, and whether it is open at first.
    - ``asks``: whether changes of the controls are made on the thread of the page, not of the
      server.
    """

    label, order, expanded, asks = "", 0.0, False, True
    _ticker: Ticker

    def __init__(self, context: LayerContext) -> None:
        self._context = context
        self._folder: Folder | None = None
        self._table: Any = None

    def show(self) -> None:
        """Follow the robot, which may have moved; cheap if nothing of the layer is shown."""

    def controls(self, client: Any) -> Controls:
        """Add a folder of controls to the commanding browser (viser.ClientHandle)."""
        self._folder = folder = self._add_folder(
            client.gui, self.label, self.order, expanded=self.expanded
        )
        with folder:
            self._fill(folder, client.gui)
        self.show()
        return folder

    def _add_folder(self, gui: Any, label: str, order: float, **options: Any) -> Folder:
        if self.asks:
            options["ask"] = self.ask
        return Folder(gui, self._context.units, label, order, **options)

    def _fill(self, folder: Folder, gui: Any) -> None:
        """Add the controls to a folder of a browser (viser.GuiApi)."""

    def write(self, name: str, facts: Sequence[tuple[str, str]]) -> None:
        """Write facts into the table of the folder, if a browser has it."""
        if self.is_open:
            self._table.content = fact_table(name, facts)

    def close(self) -> None:
        """Stop what runs; nodes go with the server."""
        if "_ticker" in vars(self):
            self._ticker.close()
        if "_worker" in vars(self):
            self._worker.close(wait=False)

    @property
    def is_open(self) -> bool:
        """True if a browser has the folder."""
        return self._folder is not None and not self._folder.removed

    @cached_property
    def _worker(self) -> Worker:
        return Worker()

    def ask(self, kind: Hashable, request: Callable[..., None], *arguments: Any) -> None:
        """Run a request on the thread of the page, with these arguments."""
        self._context.ask((self, kind), partial(request, *arguments))

    def find(self, kind: Hashable, search: Callable[[], Any], take: Callable[[Any], None]) -> None:
        """Find something on a thread of the layer, and take it on that of the page."""
        self._worker.submit(kind, lambda: self.ask(kind, take, search()))


LayerMaker = Callable[[LayerContext], Layer]
