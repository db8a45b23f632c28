"""Hands: contacts, closure and quality of a grasp, its forces and its motion (book: section 10.3).

Each part is loaded on first use: closure is compiled.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.hands.closure import (
        is_force_closed as is_force_closed,
        is_form_closed as is_form_closed,
    )
    from robomech_ros.hands.conic_solver import (
        ConicSolverUnavailableError as ConicSolverUnavailableError,
    )
    from robomech_ros.hands.contacts import Contact as Contact
    from robomech_ros.hands.forces import (
        ContactForces as ContactForces,
        ForceStatus as ForceStatus,
        contact_forces as contact_forces,
    )
    from robomech_ros.hands.grasp_map import (
        grasp_matrix as grasp_matrix,
        internal_forces as internal_forces,
    )
    from robomech_ros.hands.hand import (
        Hand as Hand,
        list_hands as list_hands,
        load_hand as load_hand,
    )
    from robomech_ros.hands.hand_motion import (
        GraspMobility as GraspMobility,
        finger_accelerations as finger_accelerations,
        finger_rates as finger_rates,
        finger_torques as finger_torques,
        grasp_mobility as grasp_mobility,
        hand_jacobian as hand_jacobian,
        object_twist as object_twist,
    )
    from robomech_ros.hands.postures import (
        grasp_postures as grasp_postures,
        hand_postures as hand_postures,
        tip_postures as tip_postures,
    )
    from robomech_ros.hands.quality import (
        GraspQuality as GraspQuality,
        grasp_quality as grasp_quality,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
