"""Other publishers of a topic."""

from rclpy.node import Node

from robomech_ros.nodes.middleware.reliable_topics import node_of

# How often the graph is looked at, s.
PERIOD = 0.5


class OtherPublishers:
    """Finds the publishers of a topic that are not a node's own.

    - ``node``: the node whose own publishers do not count.  Another node of the same name counts:
      only as many publishers as this node has are left out.
    - ``topic``: full name of the topic.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._node, self._topic = node, topic
        self._known: set[bytes] = set()
        #: Full name of the node of each other publisher at the last look.
        self.nodes: tuple[str, ...] = ()
        #: Whether a publisher disappeared between the last two looks.
        self.one_left = False

    def look(self) -> tuple[str, ...]:
        """Find the present publishers, and return their nodes."""
        found = self._node.get_publishers_info_by_topic(self._topic)
        present = {bytes(info.endpoint_gid) for info in found}
        self.one_left = bool(self._known - present)
        self._known = present
        nodes, name = sorted(map(node_of, found)), self._node.get_fully_qualified_name()
        own = sum(one.topic_name == self._topic for one in self._node.publishers)
        for _ in range(min(own, nodes.count(name))):
            nodes.remove(name)
        self.nodes = tuple(nodes)
        return self.nodes
