"""Robots: the chain model and how to come by one."""

from robomech_ros.robots.chain import PRISMATIC, REVOLUTE, LinkFrame, SerialChain
from robomech_ros.robots.description import Joint, RobotDescription
from robomech_ros.robots.dh import DHTable, chain_from_dh
from robomech_ros.robots.dh_recovery import dh_from_chain
from robomech_ros.robots.library import (
    list_robots,
    load_description,
    load_robot,
    robot_folders,
)

__all__ = [
    "PRISMATIC",
    "REVOLUTE",
    "DHTable",
    "Joint",
    "LinkFrame",
    "RobotDescription",
    "SerialChain",
    "chain_from_dh",
    "dh_from_chain",
    "list_robots",
    "load_description",
    "load_robot",
    "robot_folders",
]
