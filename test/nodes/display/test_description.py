"""The URDF on robot_description: what RViz needs, from exactly one publisher."""

from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname
from xml.etree import ElementTree

import numpy as np
import pytest
from display_cases import GRIPPER, LATCHED, PinocchioRobot, poses_in_root
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.robots import load_description, load_srdf, urdf_from_description

MESHES = """<robot name="meshed"><link name="base"/>
  <link name="arm"><visual><geometry><mesh filename="package://maker/arm.dae"/></geometry></visual>
  </link>
  <joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
</robot>"""


def described(graph, namespace=""):
    topic = f"{namespace}/robot_description" if namespace else "robot_description"
    return graph.receive(String, topic, LATCHED, lambda message: message.data).data


@pytest.mark.parametrize("name", ["puma560", "scara", "ur5e", "gen3", GRIPPER])
def test_all_that_is_described_is_on_tf_where_pinocchio_has_it(graph, robot, listener, name):
    tip = "tool0" if name == GRIPPER else ""
    positions = np.linspace(0.1, 0.2, load_description(name).chain(tip=tip).n)
    robot(robot_description=name, tip_link=tip, initial_positions=[*positions])
    urdf = described(graph)
    pinocchio = PinocchioRobot(urdf)
    listener.until(lambda: len(listener.latest()) >= len(pinocchio.links) - 1)
    state = graph.receive(JointState, "joint_states", 10, lambda message: True)
    expected = pinocchio.poses(dict(zip(state.name, state.position, strict=True)))
    found = poses_in_root(listener.latest())
    assert found.keys() == expected.keys() == set(load_description(urdf).links)
    for link, pose in expected.items():
        np.testing.assert_allclose(found[link], pose, atol=1e-12)
    # All that joints move, and the base, can be seen.
    elements = ElementTree.fromstring(urdf.encode()).findall("link")
    assert sum(link.find("visual") is not None for link in elements) > len(positions)


def test_frames_and_joint_states_belong_to_the_same_instants(graph, robot, listener):
    states = []
    graph.client.create_subscription(JointState, "joint_states", states.append, 1000)
    robot(robot_description="scara")
    listener.until(lambda: len(listener.moving) > 10)
    stamps = {(state.header.stamp.sec, state.header.stamp.nanosec) for state in states}
    for message in listener.moving[:5]:
        for entry in message.transforms:
            assert (entry.header.stamp.sec, entry.header.stamp.nanosec) in stamps


def test_meshes_and_names_of_a_urdf_stay(graph, robot):
    robot(robot_description=MESHES, frame_prefix="left/")
    text = described(graph)
    assert 'filename="package://maker/arm.dae"' in text
    assert text == urdf_from_description(load_description(MESHES))


def test_meshes_beside_the_file_are_found_from_elsewhere(graph, robot, tmp_path):
    """Names with blanks and with what means something in XML and in URLs."""
    folder = tmp_path / "left & right"
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "arm 100%.dae").write_text("")
    mesh = '<visual><geometry><mesh filename="meshes/{}"/></geometry></visual>'
    visuals = mesh.format("arm 100%.dae") + mesh.format("missing.dae").replace('"', "'")
    (folder / "robot.urdf").write_text(MESHES.replace("</link>", f"{visuals}</link>"))
    robot(robot_description=str(folder / "robot.urdf"))
    root = ElementTree.fromstring(described(graph))
    *_, kept, found, missing = [mesh.get("filename") for mesh in root.iter("mesh")]
    assert (kept, missing) == ("package://maker/arm.dae", "meshes/missing.dae")
    assert Path(url2pathname(urlsplit(found).path)) == folder / "meshes" / "arm 100%.dae"
    assert found.startswith("file:///")


def test_a_description_that_comes_from_the_topic_is_not_published_back(graph, robot, listener):
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    node = robot()
    publisher.publish(String(data=MESHES))
    listener.until_said("/tf: nobody else publishes")
    topic = "/robot_description"
    assert [info.node_name for info in node.get_publishers_info_by_topic(topic)] == ["test_client"]


def test_no_description_unless_wanted(graph, robot, listener):
    node = robot(robot_description="scara", publish_description=False)
    listener.until_said("/tf: nobody else publishes")
    assert node.count_publishers("/robot_description") == 0


def test_who_publishes_a_description_already_goes_on_alone(graph, robot, listener):
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    publisher.publish(String(data=MESHES))
    node = robot(robot_description="scara")
    listener.until_said("'/robot_description' comes from /test_client, not from here")
    listener.until_said("/tf: nobody else publishes")
    assert described(graph) == MESHES
    assert node.count_publishers("/robot_description") == 1
    # When it is gone, the robot is described here.
    graph.client.destroy_publisher(publisher)
    listener.until_said("'/robot_description' comes from here")
    assert load_description(described(graph)).name == "scara"


def test_who_comes_later_is_given_way_to(graph, robot, listener):
    node = robot(robot_description="scara")
    listener.until_said("'/robot_description' comes from here")
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    publisher.publish(String(data=MESHES))
    listener.until_said("'/robot_description' comes from /test_client, not from here")
    infos = node.get_publishers_info_by_topic("/robot_description")
    assert [info.node_name for info in infos] == ["test_client"]
    assert described(graph) == MESHES


def test_of_two_robots_in_one_namespace_one_is_described(graph, listener):
    def named(name):
        class Named(JointTrajectoryControllerNode):
            def __init__(self, **options):
                super().__init__(cli_args=["--ros-args", "-r", f"__node:={name}"], **options)

        return Named

    first = graph.start(named("first"), robot_description="scara")
    graph.start(named("second"), robot_description="puma560")
    listener.until(
        lambda: (
            any("comes from here" in log.msg for log in listener.logs)
            and any("not from here" in log.msg for log in listener.logs)
        )
    )
    listener.until(lambda: first.count_publishers("/robot_description") == 1)


SRDF = """<?xml version="1.0" encoding="utf-8"?>
<robot name="scara">
  <group name="arm"><chain base_link="base_link" tip_link="tool0"/></group>
</robot>"""


def groups(graph):
    topic = "robot_description_semantic"
    text = graph.receive(String, topic, LATCHED, lambda message: message.data).data
    return list(load_srdf(text, load_description("scara")).groups)


def test_groups_are_published_beside_the_description(graph, robot, listener, tmp_path):
    path = tmp_path / "scara.srdf"
    path.write_text(SRDF, encoding="utf-8")
    robot(robot_description="scara", robot_description_semantic=str(path))
    assert groups(graph) == ["arm"]
    listener.until_said("comes from here: groups and named states as an SRDF, for MoveIt's")
    publisher = graph.client.create_publisher(String, "robot_description_semantic", LATCHED)
    publisher.publish(String(data=SRDF.replace('"arm"', '"manipulator"')))
    listener.until_said("'/robot_description_semantic' comes from /test_client, not from here")
    assert groups(graph) == ["manipulator"]


def test_in_a_namespace(graph, listener):
    for namespace, name in (("left", "scara"), ("right", "puma560")):
        graph.start(JointTrajectoryControllerNode, namespace=namespace, robot_description=name)
    assert load_description(described(graph, "left")).name == "scara"
    assert load_description(described(graph, "right")).name == "puma560"
    assert graph.client.count_publishers("/robot_description") == 0
