"""Robots: the chain model and its sources; each part is loaded on first use."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.robots.bodies import Body as Body, combine_bodies as combine_bodies
    from robomech_ros.robots.chain import SerialChain as SerialChain
    from robomech_ros.robots.chain_layout import PRISMATIC as PRISMATIC, REVOLUTE as REVOLUTE
    from robomech_ros.robots.description import RobotDescription as RobotDescription
    from robomech_ros.robots.dh import (
        chain_from_dh as chain_from_dh,
        dh_from_axes as dh_from_axes,
        dh_from_chain as dh_from_chain,
    )
    from robomech_ros.robots.dh_table import DHTable as DHTable
    from robomech_ros.robots.drives import Drive as Drive
    from robomech_ros.robots.free_dh_parameters import (
        DHAmbiguity as DHAmbiguity,
        dh_ambiguities as dh_ambiguities,
    )
    from robomech_ros.robots.group_chains import (
        group_chain as group_chain,
        groups_by_links as groups_by_links,
        load_semantics as load_semantics,
        main_chain as main_chain,
    )
    from robomech_ros.robots.joint import Joint as Joint
    from robomech_ros.robots.library import (
        list_robots as list_robots,
        load_description as load_description,
        load_robot as load_robot,
        robot_folders as robot_folders,
    )
    from robomech_ros.robots.link_frames import LinkFrame as LinkFrame
    from robomech_ros.robots.mimic import MimicJoint as MimicJoint
    from robomech_ros.robots.semantic import (
        DisabledCollision as DisabledCollision,
        EndEffector as EndEffector,
        Group as Group,
        SemanticDescription as SemanticDescription,
        VirtualJoint as VirtualJoint,
    )
    from robomech_ros.robots.srdf.document import load_srdf as load_srdf
    from robomech_ros.robots.urdf.writer import urdf_from_description as urdf_from_description

__getattr__, __all__ = lazy_exports(__name__, globals())
