"""Tolerances of motions, also by the names that ros2_control's controller has for them."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.nodes.common.parameters import ParameterRow
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings

CONSTRAINTS = "constraints"
# Constraints per joint, each with the parameter that holds while it is NaN.
_OF_JOINTS = {"trajectory": "path_tolerance", "goal": "goal_tolerance"}
_OF_ALL = ("stopped_velocity_tolerance", "goal_time")


def constraint_rows(joint_names: Sequence[str]) -> list[ParameterRow]:
    """List the parameters ``constraints``, which may change at run time."""
    names = {f"{joint}.{name}": own for joint in joint_names for name, own in _OF_JOINTS.items()}
    names |= dict.fromkeys(_OF_ALL, "the parameter of that name")
    return [
        ParameterRow(
            name=f"{CONSTRAINTS}.{name}",
            kind=float,
            default=math.nan,
            description=f"As in ros2_control; 0 = any, NaN = {own}",
            low=0.0,
            high=3600.0,
            read_only=False,
        )
        for name, own in names.items()
    ]


def default_tolerances(
    settings: ControllerSettings, joint_names: Sequence[str], given: Mapping[str, float]
) -> Tolerances:
    """Make the tolerances that hold where a goal brings none.

    - ``settings``: tolerances of all joints.
    - ``joint_names``: the n joints.
    - ``given``: the parameters ``constraints``, as far as there are some.
    """

    def value(name: str, own: str) -> float:
        found = given.get(f"{CONSTRAINTS}.{name}", math.nan)
        return (getattr(settings, own) if math.isnan(found) else found) or math.inf

    path, goal = (
        np.array([value(f"{joint}.{name}", own) for joint in joint_names])
        for name, own in _OF_JOINTS.items()
    )
    speed, time = (value(name, name) for name in _OF_ALL)
    return Tolerances(path, goal, np.full(len(joint_names), speed), time)
