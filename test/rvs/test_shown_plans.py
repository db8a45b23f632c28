"""Plans that a page shows."""

import numpy as np
import pytest

pytest.importorskip("viser")

from raw_client import wait_until

from robomech_ros.errors import BadValueError
from robomech_ros.robots import load_description
from robomech_ros.rvs import Motion


def motion(chain):
    """Two seconds of all joints."""
    times = np.linspace(0.0, 2.0, 41)
    return Motion(chain, times, chain.home() + 0.3 * np.sin(times)[:, None])


def test_a_page_shows_plans_of_its_own_arm_only(page):
    plan = motion(page._arm.chain)
    page.show_plan(plan, "pick")
    wait_until(lambda: page._plan.motion is plan and page._plan.name == "pick")
    other = load_description("scara").chain()
    with pytest.raises(BadValueError, match="joints of the motion"):
        page.show_plan(Motion(other, [0.0], [other.home()]))
    with pytest.raises(BadValueError, match="a Motion"):
        page.show_plan("plan")
    page.forget_plan()
    wait_until(lambda: page._plan.motion is None)
