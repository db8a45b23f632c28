"""Layers of a page: each shows one subject, and brings its own folder of controls."""

from robomech_ros.rvs.layers.analysis import AnalysisLayer
from robomech_ros.rvs.layers.camera import CameraLayer
from robomech_ros.rvs.layers.contours import ContoursLayer
from robomech_ros.rvs.layers.dh_table import DHTableLayer
from robomech_ros.rvs.layers.mobile_robot import MobileRobotLayer
from robomech_ros.rvs.layers.motions import MotionLayer
from robomech_ros.rvs.layers.platform import PlatformLayer
from robomech_ros.rvs.layers.platform_workspace import PlatformWorkspaceLayer
from robomech_ros.rvs.layers.recording import RecordingLayer
from robomech_ros.rvs.layers.workspace import WorkspaceLayer
from robomech_ros.rvs.page.layer import Layer, LayerContext, LayerMaker

__all__ = ["KIND_LAYERS", "LAYERS", "PLATFORM_LAYERS"]

# In the order of their folders on the page.
LAYERS: tuple[LayerMaker, ...] = (
    CameraLayer,
    AnalysisLayer,
    DHTableLayer,
    WorkspaceLayer,
    ContoursLayer,
    MotionLayer,
    RecordingLayer,
)

# Of a page of a parallel robot.
PLATFORM_LAYERS: tuple[LayerMaker, ...] = (
    PlatformLayer,
    PlatformWorkspaceLayer,
    MotionLayer,
    CameraLayer,
)


def _hand(place: LayerContext) -> Layer:
    # What is compiled for contacts is loaded only where there are some.
    from robomech_ros.rvs.layers.hands import HandLayer

    return HandLayer(place)


def _walking(place: LayerContext) -> Layer:
    # What is compiled for legs is loaded only where there are some.
    from robomech_ros.rvs.layers.walking import WalkingLayer

    return WalkingLayer(place)


# Of robots that are no arms, by the kind that their documents say.
KIND_LAYERS: dict[str, tuple[LayerMaker, ...]] = {
    "rolling": (MobileRobotLayer, CameraLayer),
    "walking": (MobileRobotLayer, _walking, CameraLayer),
    "hand": (_hand, CameraLayer),
}
