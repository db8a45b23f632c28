"""The world around a robot: clearance, motions proved free, plans around obstacles."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.collision.departures import check_departure as check_departure
    from robomech_ros.collision.distances import Clearance as Clearance
    from robomech_ros.collision.libraries import MissingLibraryError as MissingLibraryError
    from robomech_ros.collision.meshes import Mesh as Mesh
    from robomech_ros.collision.motion_proof import MotionCheck as MotionCheck
    from robomech_ros.collision.path_ends import stop_before_contact as stop_before_contact
    from robomech_ros.collision.path_timing import (
        NotFreeError as NotFreeError,
        timed_path as timed_path,
    )
    from robomech_ros.collision.planning import PathPlan as PathPlan, PlanStatus as PlanStatus
    from robomech_ros.collision.scene import PlanningScene as PlanningScene
    from robomech_ros.collision.scene_objects import SceneObject as SceneObject
    from robomech_ros.collision.servo_guard import ServoGuard as ServoGuard
    from robomech_ros.collision.shapes import (
        Box as Box,
        Capsule as Capsule,
        Cone as Cone,
        Cylinder as Cylinder,
        Plane as Plane,
        Shape as Shape,
        Sphere as Sphere,
    )
    from robomech_ros.collision.via_paths import path_through as path_through
    from robomech_ros.robots.urdf.mesh_files import MeshError as MeshError

__getattr__, __all__ = lazy_exports(__name__, globals())
