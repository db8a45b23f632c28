"""The service run_program: starts the program in the file named by a parameter."""

from typing import Any

from rclpy.node import Node
from std_srvs.srv import Trigger

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.execution.refusals import TrajectoryRefusedError
from robomech_ros.nodes.common.deep_queues import serve
from robomech_ros.nodes.common.error_codes import NoStateError
from robomech_ros.nodes.common.parameters import NodeParameters, ParameterError
from robomech_ros.nodes.common.robot_description import RobotModel
from robomech_ros.nodes.trajectory_publisher.controller_link import ControllerLink
from robomech_ros.nodes.trajectory_publisher.dispatch_loop import DispatchLoop
from robomech_ros.nodes.trajectory_publisher.program import read_program
from robomech_ros.nodes.trajectory_publisher.program_runner import ProgramRunner
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings

__all__ = ["ProgramService"]


class ProgramService:
    """Reads a program and has it run, from where the robot is.

    Parameters
    ----------
    node : Node
        Owner of the service.
    table : NodeParameters
        Which program.
    runner : ProgramRunner
        Runs it.
    loop : DispatchLoop
        Where nothing else may be under way.
    link : ControllerLink
        Knows where the robot is.

    Attributes
    ----------
    model : RobotModel or None
        The robot, once it is known.
    """

    def __init__(
        self,
        node: Node,
        table: NodeParameters[PublisherSettings],
        runner: ProgramRunner,
        loop: DispatchLoop,
        link: ControllerLink,
    ) -> None:
        self.model: RobotModel | None = None
        self._table = table
        self._runner = runner
        self._loop = loop
        self._link = link
        serve(node, Trigger, "~/run_program", self._run_program)

    def _run_program(self, request: Any, response: Any) -> Any:
        try:
            response.message = self._start(self._table.settings.program)
            response.success = True
        except RobomechError as error:
            response.message = str(error)
        return response

    def _start(self, path: str) -> str:
        """Read a program and begin it; says so."""
        model = self.model
        if not path:
            raise BadValueError("the parameter program", path, "the path of a YAML file")
        if model is None:
            allowed = "a robot, for a program to be planned"
            raise ParameterError("robot_description", "", allowed)
        if self._runner.runs or self._loop.dispatcher.busy:
            raise TrajectoryRefusedError("something is being executed already; ~/cancel ends it")
        chain = model.chain
        program = read_program(path, chain, model.semantic)
        position = self._link.positions(chain.joint_names)
        if position is None:
            raise NoStateError(chain.joint_names, "joint_states")
        self._runner.start(program, chain, position)
        count = f"{program.cycles} cycles" if program.cycles else "cycles until cancelled"
        return f"{len(program.steps)} steps, {count}"
