"""The policy that SROS2 gets of our nodes, against the schema and against nodes that run."""

import time
from xml.etree import ElementTree

import pytest

from robomech_ros.nodes.commands.policy_xml import rights_of
from robomech_ros.nodes.process.launch_options import LaunchOptions

PATIENCE = 120.0
ENCLAVE = "/cell_1/left"
OPTIONS = ("--robot", "puma560", "--namespace", "left", "--calibration", "--view")
OPTIONS += ("--view-port", "0")
NODES = LaunchOptions(calibration=True, view=True).nodes
# Of policy.xsd in github.com/ros2/sros2: what holds what, how often, and its attributes.
HELD = {"policy": "enclaves", "enclaves": "enclave", "enclave": "profiles", "profiles": "profile"}
ATTRIBUTES = {"policy": {"version"}, "enclave": {"path"}, "profile": {"ns", "node"}}
LISTS = {
    "topics": ("topic", {"publish", "subscribe"}),
    "services": ("service", {"reply", "request"}),
    "actions": ("action", {"execute", "call"}),
}


def check_structure(element):
    """Require of an element, and of all below it, what the schema says."""
    inner = [part.tag for part in element]
    if element.tag in LISTS:
        entry, ways = LISTS[element.tag]
        assert set(element.attrib) <= ways
        assert set(element.attrib.values()) == {"ALLOW"}
        assert set(inner) == {entry}
        assert all(part.text.startswith("/") and not len(part) for part in element)
        return
    assert set(element.attrib) == ATTRIBUTES.get(element.tag, set())
    expected = set(LISTS) if element.tag == "profile" else {HELD[element.tag]}
    assert inner
    assert set(inner) <= expected
    for part in element:
        check_structure(part)


@pytest.fixture
def policy(suite):
    """Return the policy that the command writes for a robot in a namespace."""
    arguments = ("security-policies", *OPTIONS, "--enclave", ENCLAVE)
    done = suite.run("robomech", *arguments, timeout=2 * PATIENCE)
    assert done.returncode == 0, done.stderr
    return ElementTree.fromstring(done.stdout)


def allowed(policy, node, way):
    """Return what a policy lets a node do."""
    lists = policy.findall(f".//profile[@node='{node}']/*[@{way}='ALLOW']")
    return {entry.text for part in lists for entry in part}


@pytest.mark.timeout(600)
def test_the_policy_has_the_schemas_form_and_allows_what_running_nodes_do(
    policy, bringup, outsider
):
    check_structure(policy)
    assert policy.find("enclaves/enclave").get("path") == ENCLAVE
    assert [p.get("node") for p in policy.iter("profile")] == list(NODES)
    assert {p.get("ns") for p in policy.iter("profile")} == {"/left"}
    with bringup(*OPTIONS):
        deadline = time.monotonic() + PATIENCE
        for node in NODES:
            for way in ("publish", "subscribe", "reply", "request", "execute", "call"):
                wanted = allowed(policy, node, way)
                if (node, way) == ("joint_trajectory_controller", "subscribe"):
                    # It listens to frames only while others publish some, see the next lines.
                    wanted -= {"/tf", "/tf_static"}
                if (node, way) == ("rvs", "subscribe"):
                    # And the view to markers while a page shows them.
                    wanted -= {"/left/kinematics/markers", "/left/calibration/markers"}
                while (there := seen(outsider, node, way)) != wanted:
                    assert time.monotonic() < deadline, f"{node} {way}: {there ^ wanted}"
                    time.sleep(0.1)
        publish_frames(outsider.node)
        while not {"/tf", "/tf_static"} <= seen(
            outsider, "joint_trajectory_controller", "subscribe"
        ):
            assert time.monotonic() < deadline, "the controller does not listen to frames"
            time.sleep(0.1)


def seen(outsider, node, way):
    """Return what a node of the graph does; nothing while it is not there."""
    if (node, "/left") not in outsider.node.get_node_names_and_namespaces():
        return set()
    return set(rights_of(outsider.node, node, "/left").names[way])


def publish_frames(node):
    """Publish frames as others do."""
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from tf2_msgs.msg import TFMessage

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    for topic in ("/tf", "/tf_static"):
        node.create_publisher(TFMessage, topic, latched)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "--robot"),
        (("--robot", "puma560", "--enclave", "no path"), "--enclave"),
        (("--robot", "puma560", "--namespace", "a b"), "--namespace"),
    ],
)
def test_what_cannot_be_written_is_refused_with_the_option(suite, arguments, said):
    done = suite.run("robomech", "security-policies", *arguments)
    assert done.returncode == 2
    assert said in done.stderr
    assert not done.stdout
