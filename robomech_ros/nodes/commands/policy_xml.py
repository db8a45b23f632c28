"""Access policy of SROS2 for all topics, services and actions of the nodes."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from rclpy.action import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.node import Node

# Version of the format of `ros2 security`.
_VERSION = "0.2.0"
# Services and topics that an action consists of.
_PART_OF_ACTION = "/_action/"
# Element of the entries, their name, and the rights to them.
_KINDS = (
    ("topics", "topic", ("publish", "subscribe")),
    ("services", "service", ("reply", "request")),
    ("actions", "action", ("execute", "call")),
)


@dataclass(frozen=True)
class NodeRights:
    """Rights of one node.

    - ``name``, ``namespace``: name and namespace of the node.
    """

    name: str
    namespace: str
    #: Full names in alphabetical order, by right: publish and subscribe of topics, reply and
    #: request of services, execute and call of actions.
    names: Mapping[str, Sequence[str]]


def rights_of(observer: Node, name: str, namespace: str) -> NodeRights:
    """Return the rights that a node of the graph makes use of.

    - ``observer``: node that reads the graph; it may be the node itself.
    - ``name``, ``namespace``: name and namespace of the node.
    """
    at = name, namespace
    found = {
        "publish": observer.get_publisher_names_and_types_by_node(*at),
        "subscribe": observer.get_subscriber_names_and_types_by_node(*at),
        "reply": observer.get_service_names_and_types_by_node(*at),
        "request": observer.get_client_names_and_types_by_node(*at),
        "execute": get_action_server_names_and_types_by_node(observer, *at),
        "call": get_action_client_names_and_types_by_node(observer, *at),
    }
    names = {
        direction: sorted(name for name, _ in rows if _PART_OF_ACTION not in name)
        for direction, rows in found.items()
    }
    return NodeRights(name, namespace, names)


def policy_xml(rights: Iterable[NodeRights], enclave: str) -> str:
    """Write the policy of nodes that share an enclave, for ``ros2 security create_permission``.

    - ``enclave``: path of the enclave, such as ``/robomech``.
    """
    policy = ElementTree.Element("policy", version=_VERSION)
    enclaves = ElementTree.SubElement(policy, "enclaves")
    one = ElementTree.SubElement(enclaves, "enclave", path=enclave)
    profiles = ElementTree.SubElement(one, "profiles")
    for node in rights:
        profile = ElementTree.SubElement(profiles, "profile", ns=node.namespace, node=node.name)
        profile.extend(_rules(node))
    ElementTree.indent(policy)
    return ElementTree.tostring(policy, encoding="unicode", xml_declaration=True) + "\n"


def _rules(node: NodeRights) -> Iterator[ElementTree.Element]:
    for element, entry, directions in _KINDS:
        for direction in directions:
            if names := node.names[direction]:
                rule = ElementTree.Element(element, {direction: "ALLOW"})
                for name in names:
                    ElementTree.SubElement(rule, entry).text = name
                yield rule
