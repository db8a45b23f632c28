"""The node that answers questions of dynamics: efforts, accelerations, inertia, payload."""

from functools import partial
from typing import Any

import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_interfaces.srv import (
    ForwardDynamics,
    InverseDynamics,
    MassMatrix,
    SetPayload,
    SummarizeTorques,
)
from robomech_ros.dynamics import ChainDynamics, DynamicSystem, torque_summary
from robomech_ros.errors import RobomechError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.nodes.common.joints.joint_positions import JointPositions
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.joint_messages import received_trajectory
from robomech_ros.nodes.common.messages.message_fields import floats
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.robot.floating_base import FloatingRobot
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.dynamics.drives import Drives
from robomech_ros.nodes.dynamics.messages import (
    encode_summary,
    gravity_vector,
    instants,
    motions,
    payload_body,
    rates,
    tip_wrench,
    without_rates,
)
from robomech_ros.nodes.dynamics.settings import DynamicsSettings, check_settings
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.process.run import run_node
from robomech_ros.trajectory.curves.compiled_sampling import sample_many
from robomech_ros.typing import Array


class DynamicsNode(Node):
    """Inverse and forward dynamics, inertia, payload and torque summaries of one robot."""

    SETTINGS = DynamicsSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("dynamics", **options)
        self._table = NodeParameters(self, DynamicsSettings, check=check_settings)
        check_settings(self._table.settings)
        self._monitor = JointStateMonitor(self)
        when_robot_known(self, self._table.settings, self._serve, parallel=True)

    def _serve(self, model: RobotModel) -> None:
        self._model = model
        self._joints = JointPositions(model, self._monitor)
        self._floating = FloatingRobot(model, self._table.settings)
        self._drives = Drives(model, self._joints)
        self._loaded = self._empty = self._drives.system
        self._frames = RobotFrames(self, model, self._monitor, lambda: self._table.settings)
        serve(self, SetPayload, "~/set_payload", self._set_payload)
        # While one of these waits for a joint state or a frame, others are served.
        for kind, name, callback in (
            (InverseDynamics, "~/inverse_dynamics", self._inverse_dynamics),
            (SummarizeTorques, "~/summarize_torques", self._summarize_torques),
            (ForwardDynamics, "~/forward_dynamics", self._forward_dynamics),
            (MassMatrix, "~/mass_matrix", self._mass_matrix),
        ):
            serve(self, kind, name, callback, callback_group=ReentrantCallbackGroup())
        try:
            # The kernels are compiled or loaded now, not in the first request.
            self._announce(self._on_base(self._empty))
        except RobomechError as error:
            self.get_logger().warning(f"ready, but every request will be refused: {error}")

    def _announce(self, system: DynamicSystem) -> None:
        chain = self._model.chain
        system.mass_matrix(self._drives.home)
        self.get_logger().info(
            f"ready: {system.name}, {chain.base} to {chain.tip}, "
            f"{counted(len(system.joint_names), 'joint')}, moving mass {system.mass:.4g} kg"
        )

    async def _inverse_dynamics(self, request: Any, response: Any) -> Any:
        system = self._on_base(self._loaded)
        count, most = len(request.points), self._table.settings.max_batch_size
        if count > most:
            raise WrongSizeError("points", count, f"at most {most}, the parameter max_batch_size")
        names = list(request.joint_names) or list(self._drives.names)
        states = motions(request.points or [await self._present(names)], names, self._drives)
        wrench = await self._wrench(request, states.q)
        for field, rows in states.torques(system, self._gravity(request), wrench).items():
            setattr(response, field, floats(states.in_request_order(rows)))
        return answer(response)

    async def _forward_dynamics(self, request: Any, response: Any) -> Any:
        system = self._on_base(self._loaded)
        q = await self._positions(without_rates(request.state))
        velocity = rates(request.state, "velocity", self._drives, self._model)
        effort = rates(request.state, "effort", self._drives, self._model)
        wrench = (await self._wrench(request, q[None]))[0]
        acceleration = system.forward(
            q, velocity, effort, gravity=self._gravity(request), tip_wrench=wrench
        )
        response.acceleration = floats(acceleration)
        response.joint_names = list(system.drive_names)
        return answer(response)

    async def _mass_matrix(self, request: Any, response: Any) -> Any:
        system, q = self._on_base(self._loaded), await self._positions(request.state)
        response.mass_matrix = floats(system.mass_matrix(q))
        response.joint_names = list(system.drive_names)
        return answer(response)

    def _set_payload(self, request: Any, response: Any) -> Any:
        chain, given = self._model.chain, request.payload
        load = payload_body(given.inertia, self._model.link_of(given.header.frame_id), chain)
        loaded = self._empty if load is None else self._empty.with_payload(load)
        self._announce(self._on_base(loaded))
        self._loaded = loaded
        return answer(response)

    async def _summarize_torques(self, request: Any, response: Any) -> Any:
        system = self._on_base(self._loaded)
        drives, settings = self._drives, self._table.settings
        message = received_trajectory(request.trajectory)
        limits = settings.max_batch_size, settings.max_duration
        names = drives.named(list(message.joint_names))
        waypoints = read_waypoints(message, names, *limits, to_rest=False)
        times = instants(waypoints.times, settings.summary_period)
        position, velocity, acceleration = sample_many(waypoints.curve, times)[:3]
        if len(names) != len(drives.names):
            position, velocity, acceleration = (
                rows[:, drives.places] for rows in (position, velocity, acceleration)
            )
        q = drives.postures(position, "sample")
        wrench = await self._wrench(request, q)
        motion, gravity = (times, q, velocity, acceleration), self._gravity(request)
        summary = torque_summary(system, *motion, gravity=gravity, tip_wrench=wrench)
        return answer(encode_summary(summary, drives.names, response))

    def _on_base(self, system: DynamicSystem) -> DynamicSystem:
        """Return an arm on its base if that floats, or the system itself."""
        if not (self._floating.floats and isinstance(system, ChainDynamics)):
            return system
        momentum = self._table.settings.momentum or None
        # Compiled code is loaded only for such a robot.
        from robomech_ros.dynamics import FloatingDynamics

        return FloatingDynamics(self._floating.carrying(system.chain), momentum)

    async def _positions(self, state: JointState) -> Array:
        """Read the positions (n,) of a state; of an empty one, the present ones."""
        patience = self._table.settings.state_timeout
        return await self._joints.read_or_present(self._drives.linkage, state, "state", patience)

    async def _present(self, names: list[str]) -> JointTrajectoryPoint:
        """Return the present positions of joints, at rest; the reader rejects unknown names."""
        q = await self._positions(JointState())
        known = dict(zip(self._drives.joint_names, q.tolist(), strict=True))
        return JointTrajectoryPoint(positions=[known.get(name, 0.0) for name in names])

    async def _wrench(self, request: Any, q: Array) -> Array:
        """Read the wrench (m, 6) on the tip at joint values (m, n)."""
        patience = self._table.settings.state_timeout
        names = self._drives.joint_names
        return await tip_wrench(request.tip_wrench, self._frames, names, q, patience)

    def _gravity(self, request: Any) -> Array:
        return gravity_vector(request.gravity, np.array(self._table.settings.gravity))


main = partial(run_node, DynamicsNode)

if __name__ == "__main__":
    raise SystemExit(main())
