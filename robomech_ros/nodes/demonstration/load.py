"""The load of the dynamic robot, and how near to its path it must stay."""

from typing import Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParametersAtomically

from robomech_ros.nodes.demonstration.client import DemoClient
from robomech_ros.nodes.demonstration.suite import DemoFailedError

_SERVICE = "joint_trajectory_controller/set_parameters_atomically"
# What the demonstration calls besides, where the robot carries something.
CARRYING: dict[str, Any] = {_SERVICE: SetParametersAtomically}

# How far a joint may be off its path, rad or m: the controller ends a motion that is farther.
TRACKED = 0.02


def carry(client: DemoClient, mass: float) -> None:
    """Have the robot carry a mass (kg) that the controller of its drives does not know of.

    It takes the place of what the robot carries.

    Raises
    ------
    DemoFailedError
        The robot cannot carry it.
    """
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=mass)
    parameter = Parameter(name="payload_mass", value=value)
    result = client.ask(_SERVICE, SetParametersAtomically.Request(parameters=[parameter])).result
    if not result.successful:
        raise DemoFailedError(f"payload of {mass:g} kg: {result.reason}")
