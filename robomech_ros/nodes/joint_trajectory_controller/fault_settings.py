"""Faults of the simulated joints, as the parameters of the node ask for them."""

from collections.abc import Sequence

import numpy as np

from robomech_ros.execution.controller.simulated_joints import Faults
from robomech_ros.nodes.common.gripper_names import listed_names
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings


def faults_of(
    settings: ControllerSettings, joint_names: Sequence[str], others: Sequence[str] = ()
) -> Faults:
    """Read the faults of the joints of a robot; its fingers may be stuck, too.

    Raises
    ------
    ParameterError
        A joint that the robot does not have, or not one offset for every joint.
    """
    names = list(joint_names)
    stuck = listed_names(settings.fault_stuck_joints)
    for name in stuck:
        if name not in names and name not in others:
            allowed = f"names with commas between, of {', '.join((*names, *others))}"
            raise ParameterError("fault_stuck_joints", settings.fault_stuck_joints, allowed)
    offset = settings.fault_offset
    if offset and len(offset) != len(names):
        allowed = f"a list of {len(names)} numbers, for {', '.join(names)}, or empty"
        raise ParameterError("fault_offset", list(offset), allowed)
    return Faults(
        stuck=np.isin(names, stuck),
        offset=np.array(offset) if offset else np.zeros(len(names)),
        delay=settings.fault_delay,
        dropped=settings.fault_dropped_commands,
        noise=settings.fault_noise,
        seed=settings.fault_seed,
    )
