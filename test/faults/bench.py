"""The suite as processes, in a domain of its own, and everybody who works with it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from arm import Arm
from outsider import Outsider
from processes import PUBLISHER, Processes
from samples import Limits, Samples
from session import Session, Work
from simulated_time import SimulatedTime

from robomech_ros.nodes.process.free_domain import free_domain
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.robots import SerialChain, load_robot

__all__ = ["bench"]

# Rate of joint_states, Hz, and the part of real time at which simulated time goes.
_RATE, _SPEED = 500.0, 0.5


@contextmanager
def bench(
    robot: str, nodes: tuple[str, ...], *, simulated: bool, log: str
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
    log : str
        File to which what the nodes say is added.

    Yields
    ------
    session : Session
    works : mapping
        What can be under way, by the name of who asks for it.
    """
    with ExitStack() as stack:
        # What processes that are killed leave remains here.
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        os.environ["XDG_RUNTIME_DIR"] = folder
        domain = stack.enter_context(free_domain())
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        outsider = Outsider(domain)
        stack.callback(outsider.close)
        chain = load_robot(robot)
        time = SimulatedTime(outsider.node, 1.0 / _RATE, _SPEED) if simulated else None
        samples = Samples(outsider.node, _limits(chain))
        stack.callback(samples.close)
        words = stack.enter_context(open(log, "ab"))
        processes = Processes(_options(robot, simulated), nodes, words)
        stack.callback(processes.close)
        jump = time.jump if time is not None else _no_jump
        session = Session(outsider.node, processes, samples, jump)
        works = Arm(session, chain).works()
        for node in processes.nodes:
            session.until_ready(node)
        yield session, works


def _no_jump(by: float) -> None:
    raise AssertionError(f"real time does not jump by {by:g} s")


def _options(robot: str, simulated: bool) -> LaunchOptions:
    values = {
        # Plans are executed by whom they are asked for.
        f"{PUBLISHER}:planner_topic": '""',
        "use_sim_time": str(simulated).lower(),
    }
    words = [word for name, value in values.items() for word in ("-p", f"{name}:={value}")]
    return LaunchOptions(robot=robot, rate=_RATE, ros_args=tuple(words))


def _limits(chain: SerialChain) -> Limits:
    return Limits(chain.joint_names, chain.velocity, chain.acceleration)
