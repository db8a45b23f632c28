"""Nodes report at their start who can reach them."""

import os

import pytest

from robomech_ros import fastdds_shared_memory
from robomech_ros.nodes.process.discovery_range import ports_left, reach, stay_on_this_machine


@pytest.mark.parametrize(
    ("environment", "text"),
    [
        ({}, "domain 0, reached from every machine of the subnet"),
        ({"ROS_DOMAIN_ID": "7"}, "domain 7, reached from every machine of the subnet"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "localhost"}, "domain 0, reached from this machine"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, "domain 0, reached from nobody: no discovery"),
        ({"ROS_LOCALHOST_ONLY": "1"}, "domain 0, reached from this machine"),
    ],
)
def test_what_the_environment_means(environment, text):
    assert reach(environment) == text


def test_staying_on_this_machine(monkeypatch):
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "0")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    stay_on_this_machine()
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
    assert reach(os.environ).endswith("reached from this machine")


def test_ports_in_the_way_of_a_domain_are_named_and_stay(monkeypatch, tmp_path):
    monkeypatch.setattr(fastdds_shared_memory, "FOLDER", tmp_path)
    for name in ("port7001", "port7411", "port57911", "0123456789abcdef"):
        (tmp_path / f"fastdds_{name}").touch()
    said = "killed processes left ports of Fast DDS, on which messages may be lost: 7001"
    assert ports_left({}) == f"{said}, 7411"
    assert ports_left({"ROS_DOMAIN_ID": "202"}) == f"{said}, 57911"
    assert ports_left({"ROS_DOMAIN_ID": "none"}) == ports_left({"ROS_DOMAIN_ID": "3"}) == said
    assert len(list(tmp_path.iterdir())) == 4
    (tmp_path / "fastdds_port7001").unlink()
    assert ports_left({"ROS_DOMAIN_ID": "3"}) == ""
