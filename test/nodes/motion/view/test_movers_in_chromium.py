"""Robots that run over the ground, on their page in a real browser."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from browsing import IN_CHROMIUM, browser
from raw_client import wait_until

from robomech_ros.nodes.mobile_base.node import MobileBaseNode
from robomech_ros.nodes.rvs.node import RvsNode

pytestmark = IN_CHROMIUM

_PLACE = (
    "(() => {{ const b = document.querySelector('[data-jog=\"{way}\"]').getBoundingClientRect();"
    " return [b.x + b.width / 2, b.y + b.height / 2] }})()"
)


def test_a_base_drives_while_a_button_is_held_and_stands_when_it_is_let_go(graph):
    graph.start(MobileBaseNode, robot_description="omni")
    node = graph.start(RvsNode, robot_description="omni", port=0, jog_timeout=2.0)
    wait_until(node._robot._jogger._twists.get_subscription_count)
    arm = node._page._arm
    with browser(node.url) as tab:
        tab.wait_for("document.querySelector('[data-jog-pad]')")
        tab.wait_for("document.querySelector('[data-sentence]').innerText.includes('Stands')")
        at = tab.value(_PLACE.format(way="linear 0 +"))
        tab.mouse("mouseMoved", *at)

        def drives():
            # A press ends where the machine is too busy for its beats; then comes another one.
            if not node._robot.jogs:
                tab.mouse("mouseReleased", *at)
                tab.mouse("mousePressed", *at, buttons=1)
                wait_until(lambda: node._robot.jogs or arm.positions["base_x"] > 0.02)
            return arm.positions["base_x"] > 0.02

        wait_until(drives)
        tab.wait_for("__viserMutable.nodeRefFromName['/base/trail']")
        tab.mouse("mouseReleased", *at)
        wait_until(lambda: not node._robot.jogs)
        tab.wait_for("document.querySelector('[data-sentence]').innerText.includes('Stands')")
