"""The robot of a node: from a parameter, or from the latched topic ``robot_description``."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from robomech_ros.errors import RobomechError, UnknownLinkError
from robomech_ros.nodes.common.error_codes import FrameUnavailableError
from robomech_ros.nodes.common.parameters import ParameterError, parameter
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.robots import RobotDescription, SerialChain, load_description

__all__ = ["RobotModel", "RobotSettings", "when_robot_known"]

Array = NDArray[np.float64]

TOPIC = "robot_description"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(frozen=True)
class RobotSettings:
    """Parameters that every node with a robot has."""

    robot_description: str = parameter(
        "",
        "The robot: the name of one in config/robots, the path of a URDF or YAML file, or URDF "
        "text. Empty = wait for the latched topic robot_description",
    )
    base_link: str = parameter("", "First link of the chain. Empty = the root of the description")
    tip_link: str = parameter(
        "", "Last link of the chain. Empty = the one leaf that joints move, else tool0 or flange"
    )
    frame_prefix: str = parameter(
        "",
        "What the names of this robot's frames begin with in headers and on /tf, such as left/; "
        "links keep their names. As robot_state_publisher has it",
    )


class RobotModel:
    """A robot and the chain in it that a node works with.

    Parameters
    ----------
    description : RobotDescription
        The whole robot.
    base_link, tip_link : str
        Ends of the chain; empty for the defaults of the description.
    frame_prefix : str
        What the names of its frames begin with, before the name of the link.

    Raises
    ------
    ParameterError
        The prefix begins with a slash, which tf does not allow.
    """

    def __init__(
        self,
        description: RobotDescription,
        base_link: str = "",
        tip_link: str = "",
        frame_prefix: str = "",
    ):
        if frame_prefix.startswith("/"):
            expected = "a text without a slash in front, such as left/: tf has no such frames"
            raise ParameterError("frame_prefix", frame_prefix, expected)
        self.description = description
        self.frame_prefix = frame_prefix
        self.chain: SerialChain = description.chain(base_link, tip_link)
        self.joint_names = tuple(joint.name for joint in description.joints if joint.moves)
        self._chains = {self.chain.tip: self.chain, "": self.chain}
        self.fixed_frames = _fixed_frames(description, self.chain.base)

    @property
    def base_frame(self) -> str:
        """The frame of the base, as tf knows it."""
        return self.frame_of(self.chain.base)

    def frame_of(self, link: str) -> str:
        """Give the frame of a link, as tf knows it: its name behind the prefix."""
        return f"{self.frame_prefix}{link}"

    def link_of(self, frame: str) -> str:
        """Give the link of a frame; what is none of this robot's comes back as it is.

        Parameters
        ----------
        frame : str
            A link with or without the prefix, or something else.
        """
        bare = frame.removeprefix(self.frame_prefix)
        links = self.description.links
        return bare if frame not in links and bare in links else frame

    def full_frame(self, frame: str) -> str:
        """Give a frame as tf knows it, where a request may leave out the prefix; "" is the base."""
        link = self.link_of(frame or self.chain.base)
        return self.frame_of(link) if link in self.description.links else link

    def chain_to(self, link: str) -> SerialChain:
        """Give the chain from the base to any link of the robot; "" is the configured tip.

        Parameters
        ----------
        link : str
            With or without the prefix of frames.

        Raises
        ------
        UnknownLinkError
            The robot has no such link.
        RobotDescriptionError
            There is no chain to it: it is above the base, or a joint between follows another.
        """
        link = self.link_of(link)
        if link not in self._chains:
            self._chains[link] = self._new_chain(link)
        return self._chains[link]

    def _new_chain(self, link: str) -> SerialChain:
        if link not in self.description.links:
            raise UnknownLinkError(link, self.description.links)
        try:
            return self.chain.with_tip(link)
        except UnknownLinkError:
            return self.description.chain(self.chain.base, link)

    def frame_in_base(self, frame: str) -> Array | None:
        """Give the pose, shape (4, 4) (m), of a frame fixed to the base; None for the base itself.

        Raises
        ------
        FrameUnavailableError
            A link that moves, or no link of the robot.
        """
        link = self.link_of(frame)
        if not link or link == self.chain.base:
            return None
        if link in self.fixed_frames:
            return self.fixed_frames[link]
        why = "it moves with the joints" if link in self.description.links else ""
        raise FrameUnavailableError(frame, map(self.frame_of, self.fixed_frames), why)


def _fixed_frames(description: RobotDescription, base: str) -> dict[str, Array]:
    """Find all links that fixed joints, up or down the tree, hold to the base."""
    found = {base: np.eye(4)}
    waiting = [base]
    fixed = [joint for joint in description.joints if joint.type == "fixed"]
    while waiting:
        link = waiting.pop()
        for joint in fixed:
            step = joint.origin @ joint.after
            if joint.parent == link and joint.child not in found:
                found[joint.child] = found[link] @ step
                waiting.append(joint.child)
            elif joint.child == link and joint.parent not in found:
                found[joint.parent] = found[link] @ np.linalg.inv(step)
                waiting.append(joint.parent)
    return found


def when_robot_known(
    node: Node,
    settings: RobotSettings,
    on_robot: Callable[[RobotModel], None],
    supplemented: Callable[[RobotDescription], RobotDescription] | None = None,
) -> None:
    """Call back with the robot: at once if the parameter names it, otherwise when the topic has it.

    Until then the service ``~/ready`` says what is waited for.

    Parameters
    ----------
    node : Node
        Owner of the subscription.
    settings : RobotSettings
        Its parameters.
    on_robot : callable
        Called once, and again after a RobomechError, with which it refuses a robot of the topic.
    supplemented : callable, optional
        Gives the robot what its description lacks.

    Raises
    ------
    RobomechError
        The parameter's robot is unknown or broken.  What is wrong with a robot from the topic is
        logged, and the node goes on waiting for a better one.
    """
    base, tip, prefix = settings.base_link, settings.tip_link, settings.frame_prefix

    def model_of(robot: str) -> RobotModel:
        description = load_description(robot)
        whole = supplemented(description) if supplemented else description
        return RobotModel(whole, base, tip, prefix)

    if settings.robot_description:
        on_robot(model_of(settings.robot_description))
        Readiness(node)
        return
    known: list[RobotModel] = []

    def receive(message: String) -> None:
        if known:
            text = "a new robot description is ignored; restart the node to change its robot"
            node.get_logger().warning(text)
            return
        try:
            model = model_of(message.data)
            on_robot(model)
        except RobomechError as error:
            text = f"unusable robot on '{subscription.topic_name}': {error}"
            node.get_logger().error(text)
            readiness.wait_for(text)
            return
        known.append(model)
        readiness.reached()

    subscription = node.create_subscription(String, TOPIC, receive, LATCHED)
    readiness = Readiness(
        node,
        f"waiting for the robot on topic '{subscription.topic_name}' (a latched std_msgs/String, "
        "as robot_state_publisher has it); else name it by the parameter robot_description of "
        f"'{node.get_fully_qualified_name()}'. Its other services come with the robot",
    )
