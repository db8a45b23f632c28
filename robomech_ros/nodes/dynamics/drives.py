"""The drives that requests about dynamics speak of, and all joints of the robot for them."""

import numpy as np

from robomech_ros.dynamics import ChainDynamics, DynamicSystem
from robomech_ros.execution.rejections import JointMismatchError
from robomech_ros.nodes.common.joints.joint_positions import JointPositions, Linkage
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.typing import Array


class Drives:
    """The m drives of a robot with n joints: all of a chain, some of a parallel robot.

    - ``joints``: reads states, and knows the present posture.
    - ``names``: the drives.
    - ``joint_names``: all joints.
    - ``home``: a posture of it (rad or m), shape (n,).
    """

    def __init__(self, model: RobotModel, joints: JointPositions) -> None:
        self.system: DynamicSystem  #: The system that computes the dynamics, without a payload.
        if model.mechanism is None:
            self.linkage: Linkage = model.chain  #: The joints that states are read for.
            self.system, self.home = ChainDynamics(model.chain), model.chain.midrange()
        else:
            from robomech_ros.parallel import ParallelDynamics

            self.linkage, self.home = model.mechanism, model.mechanism.home()
            self.system = ParallelDynamics(model.mechanism)
        self.names, self.joint_names = self.system.drive_names, self.system.joint_names
        self.places = self.system.drives_at  #: Drives among all joints, shape (m,).
        self._joints = joints

    def named(self, names: list[str]) -> tuple[str, ...]:
        """Say which joints a list is to name: all of them if it is that long, else the drives.

        Raises JointMismatchError: some passive joints of a parallel robot are among them, and not
        all.
        """
        if len(names) == len(self.joint_names):
            return self.joint_names
        passive = next((one for one in names if one in {*self.joint_names} - {*self.names}), None)
        if passive is not None:
            drives, count = ", ".join(self.names), len(self.joint_names)
            expected = f"the drives alone, {drives}, or all {count} joints; '{passive}' is passive"
            raise JointMismatchError("joint_names", len(names), expected)
        return self.names

    def postures(self, rows: Array, what: str) -> Array:
        """Return all joints (k, n) for positions of the drives (k, m), or of all joints (k, n).

        Loops of a parallel robot are closed, each row in the assembly mode of that before, and the
        first in that of the present posture, or nearest to home where it is not known.

        Raises LoopClosureError: all joints are given, and leave loops open. OutcomeError: the
        drives can hold the platform nowhere, or a singular posture is in their way.
        """
        loops = self._joints.loops
        if loops is None:
            return rows
        if rows.shape[1] == len(self.joint_names):
            closed = [loops.closed(row, f"{what}[{k}]") for k, row in enumerate(rows)]
            return np.array(closed).reshape(rows.shape)
        near, found = self._joints.present_posture(), np.empty((len(rows), len(self.joint_names)))
        for k, row in enumerate(rows):
            near = found[k] = loops.complete(row, f"{what}[{k}]", near)
        return found
