"""The service run_program: starts the program in the file named by a parameter."""

from functools import partial
from pathlib import Path

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.messages.error_codes import NoStateError
from robomech_ros.nodes.common.parameters import NodeParameters, ParameterError
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.services import serve_trigger
from robomech_ros.nodes.trajectory_publisher.controller_client import ControllerClient
from robomech_ros.nodes.trajectory_publisher.dispatch_loop import DispatchLoop
from robomech_ros.nodes.trajectory_publisher.program import Program, read_program
from robomech_ros.nodes.trajectory_publisher.program_runner import ProgramRunner
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array


class ProgramService:
    """Reads a program and has it run, from where the robot is.

    - ``table``: parameters, which name the program.
    - ``runner``: runs the program.
    - ``loop``: executes motions; it must be idle when a program starts.
    - ``link``: knows the positions of the joints.
    """

    def __init__(
        self,
        node: Node,
        table: NodeParameters[PublisherSettings],
        runner: ProgramRunner,
        loop: DispatchLoop,
        link: ControllerClient,
    ) -> None:
        self.model: RobotModel | None = None  #: The robot, once it is known.
        self._table, self._runner, self._loop, self._link = table, runner, loop, link
        self._worker = Worker(node)
        group = ReentrantCallbackGroup()
        serve_trigger(node, "~/run_program", self._start, callback_group=group)

    def give_up(self, reason: str) -> None:
        """Answer the requests that wait for a program to begin."""
        self._worker.give_up(reason)

    def destroy(self) -> None:
        """End the thread that reads programs."""
        self._worker.close()

    async def _start(self) -> str:
        """Read a program and begin it; says so."""
        model, path = self.model, program_file(self._table.settings)
        if model is None:
            allowed = "a robot, for a program to be planned"
            raise ParameterError("robot_description", "", allowed)
        if model.mechanism is not None:
            allowed = "a robot without loops: programs are of chains"
            raise ParameterError("robot_description", model.mechanism.name, allowed)
        if self._runner.runs:
            raise self._busy()
        place = self._place(model.chain)
        # Thousands of moves take seconds, in which others are served and it can be cancelled.
        self._runner.prepare()
        try:
            program = await self._worker.do(partial(self._planned, path, model, place))
        except RobomechError as error:
            self._runner.cancel(str(error))
            raise
        if not self._runner.end_preparation():
            raise TrajectoryRefusedError(self._runner.condition)
        self._runner.start(program, model.chain, self._place(model.chain))
        count = counted(program.cycles, "cycle") if program.cycles else "cycles until cancelled"
        return f"{counted(len(program.steps), 'step')}, {count}"

    def _place(self, chain: SerialChain) -> Array:
        """Return where the robot stands (rad or m), while nothing is executed."""
        if self._loop.dispatcher.busy:
            raise self._busy()
        position = self._link.positions(chain.joint_names)
        if position is None:
            raise NoStateError(chain.joint_names, "joint_states")
        return position

    def _planned(self, path: Path, model: RobotModel, place: Array) -> Program:
        """Read a program all of whose moves can be planned; runs beside the executor."""
        program = read_program(path, model.chain, model.semantic)
        self._runner.check(program, model.chain, place)
        return program

    @staticmethod
    def _busy() -> TrajectoryRefusedError:
        return TrajectoryRefusedError("something is being executed already; ~/cancel ends it")


def program_file(settings: PublisherSettings) -> Path:
    """Find the file of the program; a request cannot name a file outside the folder of programs.

    Raises BadValueError: the parameter ``program`` is empty. ParameterError: the file is outside
    the folder of programs.
    """
    name, folder = settings.program, settings.program_folder
    if not name:
        raise BadValueError("the parameter program", name, "the path of a YAML file")
    if not folder:
        return Path(name).expanduser()
    allowed = f"the name of a file in program_folder, '{folder}'"
    try:
        place = Path(folder).expanduser().resolve()
        path = (place / name).resolve()
    except (OSError, RuntimeError, ValueError):  # links in a circle, a null character
        raise ParameterError("program", name, allowed) from None
    if not path.is_relative_to(place):
        raise ParameterError("program", name, allowed)
    return path


def check_program_change(before: PublisherSettings, after: PublisherSettings) -> None:
    """Refuse a program that is set at run time, unless it is in the folder of programs.

    Raises ParameterError: the program is outside that folder, or there is no such folder.
    """
    if after.program == before.program or not after.program:
        return
    if not after.program_folder:
        allowed = "what was given at start, as there is no program_folder"
        raise ParameterError("program", after.program, allowed)
    program_file(after)
