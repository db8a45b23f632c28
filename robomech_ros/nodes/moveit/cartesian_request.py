"""Requests of compute_cartesian_path, read and checked field by field."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from moveit_msgs.msg import MoveItErrorCodes

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.common.messages.message_fields import (
    check_waypoints,
    finite_number,
    not_negative,
)
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.moveit.constraints import Conditions, frames_of
from robomech_ros.nodes.moveit.serving import chain_of, refused_as
from robomech_ros.nodes.moveit.whole_robot import Positions, WholeRobot
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# Finer steps would fill the memory, slower motions would take years.
_LEAST_STEP, _LEAST_SPEED, _LEAST_SCALE = 1e-5, 1e-6, 1e-6


@dataclass(frozen=True, eq=False)
class ChainRequest:
    """Checked content of a request for a motion of a chain.

    - ``velocity_scale``, ``acceleration_scale``: parts of the limits that may be used.
    """

    chain: SerialChain  #: The chain that moves.
    positions: Positions  #: Positions of all known joints (rad or m).
    velocity_scale: float
    acceleration_scale: float
    limited: SerialChain  #: Chain to the link with limited speed.
    speed: float  #: Largest speed of that link (m/s); infinite for any.

    @property
    def start(self) -> Array:
        """Joint values of the chain at the start, shape (n,)."""
        return np.array([self.positions[name] for name in self.chain.joint_names])


@dataclass(frozen=True, eq=False)
class CartesianQuestion(ChainRequest):
    """Checked content of a Cartesian request, whose chain leads to the link on the path.

    - ``revolute_jump``, ``prismatic_jump``: largest move of a joint between two points, rad and m;
      infinite for any.
    """

    joint_names: tuple[str, ...]  #: Joints of the group, in the order of the answer.
    waypoints: Array  #: Poses of the link in the base (m), shape (m, 4, 4).
    step: float  #: Largest distance of neighbouring points (m).
    #: Largest move of the joints between two points, over the mean; infinite for any.
    relative_jump: float
    revolute_jump: float
    prismatic_jump: float
    conditions: Conditions  #: Conditions that hold along the whole path.


async def read_question(request: Any, robot: WholeRobot, settings: Any) -> CartesianQuestion:
    """Read a request.

    - ``request``: GetCartesianPath.Request.
    - ``settings``: PlannerSettings.

    Raises RejectedError: the node cannot serve a part of the request; the code says which.
    """
    chain = chain_of(robot.model, request.group_name, request.link_name)
    numbers = _numbers(request)
    slow = getattr(request, "cartesian_speed_limited_link", "")
    limited = chain_of(robot.model, "", slow) if slow else chain
    frame = robot.model.link_of(request.header.frame_id)
    with refused_as(MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS):
        check_waypoints("waypoints", len(request.waypoints), settings.max_waypoints)
        if not request.waypoints:
            raise BadValueError("waypoints", [], "at least one pose")
        poses = [matrix_from_pose(p, f"waypoints[{k}]") for k, p in enumerate(request.waypoints)]
        frames = [frame, *frames_of(request.path_constraints)]
        places = await robot.places(frames, settings.state_timeout)
        conditions = Conditions(request.path_constraints, robot, places, "path_constraints")
    own = frame == chain.tip and bool(chain.n)
    with refused_as(MoveItErrorCodes.START_STATE_INVALID):
        joints = (
            *chain.joint_names,
            *limited.joint_names,
            *conditions.joints,
            *places[frame].joint_names,
            *robot.joints_to_base_of(chain),
        )
        positions = await robot.start(request.start_state, joints, settings)
    to_base = robot.in_base_of(chain, places[frame].pose(positions), positions)
    return CartesianQuestion(
        chain=chain,
        joint_names=robot.model.joints_of(request.group_name),
        positions=positions,
        # Waypoints in the frame of the chain's tip count each from the last.
        waypoints=_chained(to_base, poses) if own else to_base @ np.stack(poses),
        conditions=conditions,
        limited=limited,
        **numbers,
    )


def _chained(pose: Array, steps: list[Array]) -> Array:
    """Return poses each of which is given in the frame of the one before."""
    return np.stack([pose := pose @ step for step in steps])


def _numbers(request: Any) -> dict[str, float]:
    with refused_as(MoveItErrorCodes.FAILURE):
        jump = _at_least_zero(request, "jump_threshold")
        if 0.0 < jump <= 1.0:
            expected = "more than 1, times the mean move between two points, or 0 for any"
            raise BadValueError("jump_threshold", jump, expected)
        step = _finite(request, "max_step")
        if not step >= _LEAST_STEP:
            raise BadValueError("max_step", step, f"at least {_LEAST_STEP:g} m")
        speed = _finite(request, "max_cartesian_speed")
        if 0.0 < speed < _LEAST_SPEED:
            expected = f"at least {_LEAST_SPEED:g} m/s, or 0 for any"
            raise BadValueError("max_cartesian_speed", speed, expected)
        return {
            "step": step,
            "relative_jump": jump or math.inf,
            "revolute_jump": _at_least_zero(request, "revolute_jump_threshold") or math.inf,
            "prismatic_jump": _at_least_zero(request, "prismatic_jump_threshold") or math.inf,
            "velocity_scale": read_scale(request, "max_velocity_scaling_factor"),
            "acceleration_scale": read_scale(request, "max_acceleration_scaling_factor"),
            # As in MoveIt a speed below zero, too, is none.
            "speed": speed if speed > 0.0 else math.inf,
        }


def _finite(request: Any, name: str) -> float:
    return finite_number(name, getattr(request, name, 0.0))  # some fields are missing in Humble


def _at_least_zero(request: Any, name: str) -> float:
    return not_negative(name, _finite(request, name), "a positive number, or 0 for any move")


def read_scale(request: Any, name: str) -> float:
    """Read which part of a limit a request may use; 0 is all of it."""
    value = _finite(request, name)
    if value and not _LEAST_SCALE <= value <= 1.0:
        raise BadValueError(name, value, f"at least {_LEAST_SCALE:g} and at most 1, or 0 for 1")
    return value or 1.0
