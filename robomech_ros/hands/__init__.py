"""Hands: contacts, closure and quality of a grasp, its forces and its motion (book: section 10.3).

Each part is loaded on first use: closure is compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.hands.closure import is_force_closed, is_form_closed
    from robomech_ros.hands.conic_solver import ConicSolverUnavailableError
    from robomech_ros.hands.contacts import Contact
    from robomech_ros.hands.forces import ContactForces, ForceStatus, contact_forces
    from robomech_ros.hands.grasp_map import grasp_matrix, internal_forces
    from robomech_ros.hands.hand import Hand, list_hands, load_hand
    from robomech_ros.hands.hand_motion import (
        GraspMobility,
        finger_accelerations,
        finger_rates,
        finger_torques,
        grasp_mobility,
        hand_jacobian,
        object_twist,
    )
    from robomech_ros.hands.postures import grasp_postures, hand_postures, tip_postures
    from robomech_ros.hands.quality import GraspQuality, grasp_quality

__all__ = [
    "ConicSolverUnavailableError",
    "Contact",
    "ContactForces",
    "ForceStatus",
    "GraspMobility",
    "GraspQuality",
    "Hand",
    "contact_forces",
    "finger_accelerations",
    "finger_rates",
    "finger_torques",
    "grasp_matrix",
    "grasp_mobility",
    "grasp_postures",
    "grasp_quality",
    "hand_jacobian",
    "hand_postures",
    "internal_forces",
    "is_force_closed",
    "is_form_closed",
    "list_hands",
    "load_hand",
    "object_twist",
    "tip_postures",
]

_MODULES = {
    "Contact": "contacts",
    "is_force_closed": "closure",
    "is_form_closed": "closure",
    "ConicSolverUnavailableError": "conic_solver",
    "ContactForces": "forces",
    "ForceStatus": "forces",
    "contact_forces": "forces",
    "grasp_matrix": "grasp_map",
    "internal_forces": "grasp_map",
    "Hand": "hand",
    "list_hands": "hand",
    "load_hand": "hand",
    "GraspMobility": "hand_motion",
    "finger_accelerations": "hand_motion",
    "finger_rates": "hand_motion",
    "finger_torques": "hand_motion",
    "grasp_mobility": "hand_motion",
    "hand_jacobian": "hand_motion",
    "object_twist": "hand_motion",
    "grasp_postures": "postures",
    "tip_postures": "postures",
    "hand_postures": "postures",
    "GraspQuality": "quality",
    "grasp_quality": "quality",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
