"""Runs a program: plans one move after the other and has each executed."""

from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.node import Node
from rclpy.timer import Timer

from robomech_ros.errors import RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.execution.client.execution_request import (
    ExecutionReport,
    ExecutionRequest,
    Transport,
)
from robomech_ros.nodes.common.cooperative_wait import passing_timer
from robomech_ros.nodes.common.messages.joint_messages import joint_trajectory
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.trajectory_publisher.program import Program, Step
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory.joint_points import nearest_turns
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

_PERIOD = 0.01


class ProgramRunner:
    """Runs one program at a time.

    - ``offer``: queues an execution request.
    - ``transport``: how moves reach the controller.
    - ``limits``: most points of a trajectory, and how long it may be (s).
    """

    def __init__(
        self,
        node: Node,
        clock: MotionClock,
        offer: Callable[[ExecutionRequest], None],
        transport: Transport,
        limits: tuple[int, float],
    ) -> None:
        self.condition = ""  #: State of the program, or how the last one ended.
        self._node, self._clock, self._offer, self._transport = node, clock, offer, transport
        self._max_points, self._max_duration = limits
        self._preparing = False
        self._program: Program | None = None
        self._timer: Timer | None = None
        self._done = 0

    @property
    def runs(self) -> bool:
        """True if a program runs, or is about to."""
        return self._preparing or self._program is not None

    def prepare(self) -> None:
        """Note that a program is being read and planned; `cancel` ends that, too."""
        self._preparing = True
        self.condition = "program being planned"

    def end_preparation(self) -> bool:
        """Note that it is no longer; says whether nobody cancelled it."""
        goes_on, self._preparing = self._preparing, False
        return goes_on

    def check(self, program: Program, chain: SerialChain, place: Array) -> None:
        """Plan a program from the present positions (rad or m), in any thread; or RobomechError."""
        known = set()
        for step in (*program.steps, *program.steps[: program.cycles != 1]):
            if step.posture:
                move = (tuple(place), step.positions, tuple(step.options.items()))
                if move not in known:
                    self._plan(step, chain, place)
                    known.add(move)
                place = np.array(step.positions)

    def start(self, program: Program, chain: SerialChain, position: Array) -> None:
        """Begin a program that was checked, from where the robot is (rad or m)."""
        self._chain, self._position, self._done = chain, position, 0
        self._program = program
        self._next()

    def cancel(self, text: str) -> bool:
        """End the program for a reason; returns whether one ran or was about to."""
        if not self.runs:
            return False
        self._preparing = False
        self._end(text)
        return True

    def _next(self) -> None:
        program = self._program
        if program is None:
            return
        cycle, index = divmod(self._done, len(program.steps))
        if program.cycles and cycle >= program.cycles:
            self._end(f"program done: {counted(cycle, 'cycle')}")
            return
        step = program.steps[index]
        what = f"move to {step.posture}" if step.posture else f"wait {step.wait:g} s"
        self.condition = f"program, cycle {cycle + 1}, step {index + 1}: {what}"
        self._done += 1
        if not step.posture:
            wait = max(step.wait, 1e-3)
            self._timer = passing_timer(self._node, wait, self._waited, self._clock.clock)
            return
        try:
            points = self._plan(step, self._chain, self._position)
            names = list(self._chain.joint_names)
            rows: Any = (points.times, points.positions, points.velocities, points.accelerations)
            trajectory = joint_trajectory(names, *rows)
            execution = ExecutionRequest(trajectory, names, points, self._transport)
            execution.listen(self._moved)
            self._position = points.positions[-1]
            self._offer(execution)
        except RobomechError as error:
            self._end(f"{self.condition}: {error}")

    def _waited(self) -> None:
        self._drop_timer()
        self._next()

    def _moved(self, report: ExecutionReport) -> None:
        if report.code and self.runs:
            self._end(f"{self.condition}: {report.text}")
        else:
            self._next()

    def _plan(self, step: Step, chain: SerialChain, start: Array) -> Waypoints:
        # Compiled code, 100 MB and seconds, that a publisher without programs does without.
        from robomech_ros.trajectory.plans.fitting_plan import fitting_plan

        plan = fitting_plan(
            chain,
            nearest_turns(np.stack([start, step.positions]), chain.continuous)[0],
            wanted_period=0.0,
            usual_period=_PERIOD,
            max_points=self._max_points,
            max_duration=self._max_duration,
            **step.options,
        )
        return plan.waypoints

    def _end(self, text: str) -> None:
        self._program = None
        self._drop_timer()
        self.condition = text
        self._node.get_logger().info(text)

    def _drop_timer(self) -> None:
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None
