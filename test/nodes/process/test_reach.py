"""Who can reach the nodes is said at their start."""

import os

import pytest

from robomech_ros.nodes.process.reach import reach, stay_on_this_machine


@pytest.mark.parametrize(
    ("environment", "text"),
    [
        ({}, "domain 0, reached from every machine of the subnet"),
        ({"ROS_DOMAIN_ID": "7"}, "domain 7, reached from every machine of the subnet"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "localhost"}, "domain 0, reached from this machine"),
        (
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"},
            "domain 0, reached from nobody: no discovery",
        ),
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
