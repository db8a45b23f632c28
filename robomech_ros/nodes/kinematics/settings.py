"""Parameters of the node kinematics."""

from dataclasses import dataclass

from robomech_ros.nodes.common.joints.joint_positions import StateSettings
from robomech_ros.nodes.common.parameters import changeable
from robomech_ros.nodes.common.robot.floating_base import FloatingSettings


@dataclass(frozen=True)
class KinematicsSettings(FloatingSettings, StateSettings):
    """Parameters of the node."""

    max_batch_size: int = changeable(
        10_000,
        "Largest number of poses in one request of SolveIKBatch or QueryWorkspace, and in one "
        "answer of SolveFK",
        (1, 10_000_000, "poses"),
    )
    batch_timeout: float = changeable(
        60.0,
        "Time limit of one SolveIKBatch or QueryWorkspace request; the remaining poses then get "
        "the code TIMED_OUT. Other requests are served meanwhile",
        (0.001, 3600.0, "s"),
    )
    publish_markers: bool = changeable(
        True,
        "Show the last analysed posture and the workspace boundary on ~/markers. The boundary is "
        "computed at the first subscription or call of query_workspace",
    )
