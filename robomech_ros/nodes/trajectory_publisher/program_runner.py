"""Runs a program: plans one move after the other and has each executed."""

from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.node import Node
from rclpy.timer import Timer

from robomech_ros.errors import RobomechError
from robomech_ros.execution.client.delivery import Delivery, DeliveryReport, Transport
from robomech_ros.nodes.common.joint_messages import joint_trajectory
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.trajectory_publisher.program import Program, Step
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["ProgramRunner"]

_PERIOD = 0.01


class ProgramRunner:
    """Runs one program at a time.

    Parameters
    ----------
    node : Node
        Owner of the timers of waits, and whose log tells how a program ended.
    clock : MotionClock
        The time of waits.
    offer : callable
        Queues a delivery.
    transport : Transport
        How moves reach the controller.
    limits : tuple of int and float
        Most points of a trajectory, and how long it may be (s).

    Attributes
    ----------
    condition : str
        What it is doing, or how the last program ended.
    """

    def __init__(
        self,
        node: Node,
        clock: MotionClock,
        offer: Callable[[Delivery], None],
        transport: Transport,
        limits: tuple[int, float],
    ) -> None:
        self.condition = ""
        self._node = node
        self._clock = clock
        self._offer = offer
        self._transport = transport
        self._max_points, self._max_duration = limits
        self._program: Program | None = None
        self._timer: Timer | None = None
        self._done = 0

    @property
    def runs(self) -> bool:
        """Whether a program runs."""
        return self._program is not None

    def start(self, program: Program, chain: SerialChain, position: FloatArray) -> None:
        """Begin a program, from where the robot is (rad or m).

        Raises
        ------
        RobomechError
            One of its moves cannot be planned; the robot does not move then.
        """
        self._chain, self._position, self._done = chain, position, 0
        place = position
        for step in (*program.steps, *program.steps[: program.cycles != 1]):
            if step.posture:
                self._plan(step, place)
                place = np.array(step.positions)
        self._program = program
        self._next()

    def cancel(self, text: str) -> bool:
        """End the program for a reason; returns whether one ran."""
        if self._program is None:
            return False
        self._end(text)
        return True

    def _next(self) -> None:
        """Do the step whose turn it is."""
        program = self._program
        if program is None:
            return
        cycle, index = divmod(self._done, len(program.steps))
        if program.cycles and cycle >= program.cycles:
            self._end(f"program done: {cycle} cycles")
            return
        step = program.steps[index]
        what = f"move to {step.posture}" if step.posture else f"wait {step.wait:g} s"
        self.condition = f"program, cycle {cycle + 1}, step {index + 1}: {what}"
        self._done += 1
        if not step.posture:
            self._timer = self._node.create_timer(
                max(step.wait, 1e-3), self._waited, clock=self._clock.clock
            )
            return
        try:
            delivery = self._plan(step, self._position)
            delivery.listen(self._moved)
            self._position = np.array(step.positions)
            self._offer(delivery)
        except RobomechError as error:
            self._end(f"{self.condition}: {error}")

    def _waited(self) -> None:
        self._drop_timer()
        self._next()

    def _moved(self, report: DeliveryReport) -> None:
        if report.code and self.runs:
            self._end(f"{self.condition}: {report.text}")
        else:
            self._next()

    def _plan(self, step: Step, start: FloatArray) -> Delivery:
        # Compiled code, 100 MB and seconds, that a publisher without programs does without.
        from robomech_ros.trajectory.plans.fitting_plan import fitting_plan

        plan = fitting_plan(
            self._chain,
            np.stack([start, step.positions]),
            wanted_period=0.0,
            usual_period=_PERIOD,
            max_points=self._max_points,
            max_duration=self._max_duration,
            **step.options,
        )
        names, points = list(self._chain.joint_names), plan.waypoints
        rows: Any = (points.times, points.positions, points.velocities, points.accelerations)
        return Delivery(joint_trajectory(names, *rows), names, points, self._transport)

    def _end(self, text: str) -> None:
        self._program = None
        self._drop_timer()
        self.condition = text
        self._node.get_logger().info(text)

    def _drop_timer(self) -> None:
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None
