"""Robots: the chain model, and where chains come from."""

from robomech_ros.robots.bodies import Body, combine_bodies
from robomech_ros.robots.chain import LinkFrame, SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, REVOLUTE
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.dh import chain_from_dh, dh_from_chain
from robomech_ros.robots.dh_axes import dh_from_axes
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.robots.drives import Drive
from robomech_ros.robots.group_chains import (
    group_chain,
    groups_by_links,
    load_semantics,
    main_chain,
)
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.library import list_robots, load_description, load_robot, robot_folders
from robomech_ros.robots.mimic import MimicJoint
from robomech_ros.robots.semantic import (
    DisabledCollision,
    EndEffector,
    Group,
    SemanticDescription,
    VirtualJoint,
)
from robomech_ros.robots.srdf.document import load_srdf
from robomech_ros.robots.urdf.writer import urdf_from_description

__all__ = [
    "PRISMATIC",
    "REVOLUTE",
    "Body",
    "DHTable",
    "DisabledCollision",
    "Drive",
    "EndEffector",
    "Group",
    "Joint",
    "LinkFrame",
    "MimicJoint",
    "RobotDescription",
    "SemanticDescription",
    "SerialChain",
    "VirtualJoint",
    "chain_from_dh",
    "combine_bodies",
    "dh_from_axes",
    "dh_from_chain",
    "group_chain",
    "groups_by_links",
    "list_robots",
    "load_description",
    "load_robot",
    "load_semantics",
    "load_srdf",
    "main_chain",
    "robot_folders",
    "urdf_from_description",
]
