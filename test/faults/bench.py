"""The suite as processes, in a domain of its own, and everybody who works with it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
from arm import Arm
from gripper_cases import panda_with_hand
from outsider import Outsider
from processes import CONTROLLER, PUBLISHER, Processes
from samples import Limits, Samples
from session import Session, Work
from simulated_time import SimulatedTime

from robomech_ros.execution.joints import TIME_TO_SPEED, Joints
from robomech_ros.nodes.process.free_domain import free_domain
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.robots import SerialChain, load_description, load_robot
from robomech_ros.robots.fingers import finger_joints

__all__ = ["bench"]

# Rate of joint_states, Hz, and the part of real time at which simulated time goes.
_RATE, _SPEED = 500.0, 0.5
# Where the arm with a hand ends, and how fast its fingers may be, m/s: a fault comes on their way.
_TIP, _OF_FINGERS = "panda_hand_tcp", 0.01


@contextmanager
def bench(
    robot: str, nodes: tuple[str, ...], *, simulated: bool, fingers: bool, log: str
) -> Iterator[tuple[Session, dict[str, Work]]]:
    """Bring a suite up, and take it down.

    Parameters
    ----------
    robot : str
        As for ``robomech bringup --robot``.
    nodes : tuple of str
        Which nodes there are.
    simulated : bool
        Whether all nodes have simulated time.
    fingers : bool
        Whether the robot is the Panda with a hand.
    log : str
        File to which what the nodes say is added.

    Yields
    ------
    session : Session
    works : mapping
        What can be under way, by the name of who asks for it.
    """
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        domain = stack.enter_context(free_domain())
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        outsider = Outsider(domain)
        stack.callback(outsider.close)
        words = _parameters(simulated)
        options = LaunchOptions(robot=robot, rate=_RATE, auto_execute=True, ros_args=words)
        if fingers:
            hand = Path(folder, "panda_with_hand.urdf")
            hand.write_text(panda_with_hand(), encoding="utf-8")
            options = replace(options, robot=str(hand), tip_link=_TIP)
        chain = load_robot(options.robot, tip=options.tip_link or None)
        time = SimulatedTime(outsider.node, 1.0 / _RATE, _SPEED) if simulated else None
        samples = Samples(outsider.node, _limits(options.robot, chain))
        stack.callback(samples.close)
        words = stack.enter_context(open(log, "ab"))
        processes = Processes(options, nodes, words)
        stack.callback(processes.close)
        jump = time.jump if time is not None else _no_jump
        session = Session(outsider.node, processes, samples, jump)
        works = Arm(session, chain).works()
        for node in processes.nodes:
            session.until_ready(node)
        yield session, works


def _no_jump(by: float) -> int:
    raise AssertionError(f"real time does not jump by {by:g} s")


def _parameters(simulated: bool) -> tuple[str, ...]:
    values = {
        # Only plans that a caller publishes are executed.
        f"{PUBLISHER}:planner_topic": '""',
        f"{CONTROLLER}:gripper_max_velocity": str(_OF_FINGERS),
        "use_sim_time": str(simulated).lower(),
    }
    return tuple(word for name, value in values.items() for word in ("-p", f"{name}:={value}"))


def _limits(robot: str, chain: SerialChain) -> Limits:
    """Return the limits of the arm, and behind them those of its fingers."""
    fingers = finger_joints(load_description(robot), chain)
    return Limits(
        (*chain.joint_names, *(finger.name for finger in fingers)),
        np.append(chain.velocity, [_OF_FINGERS for _ in fingers]),
        np.append(
            Joints.of(chain).acceleration, [finger.velocity / TIME_TO_SPEED for finger in fingers]
        ),
    )
