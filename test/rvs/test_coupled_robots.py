"""Pages of robots on which joints follow others."""

from dataclasses import replace

import msgspec.msgpack
import numpy as np
import pytest

pytest.importorskip("viser")

from raw_client import Client, camera, wait_until

from robomech_ros.errors import BadValueError
from robomech_ros.rvs import view
from robomech_ros.rvs.layers.dh_table import NO_TABLE
from robomech_ros.rvs.model.motions.planning import JOINTS, LINE, plan_between
from robomech_ros.rvs.model.workspace.workspace_views import section_view, why_no_section
from test.coupled_robots import DATA, coupled


@pytest.mark.parametrize("name", ["palletizer", "coupled_finger", "hollow_wrist"])
def test_a_page_has_a_slider_for_each_drive_and_moves_the_followers(name):
    chain = coupled(name)
    with view(DATA / f"{name}.urdf", port=0) as page, Client(page).connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._audience.commander is not None and page._panel is not None)
        assert len(page._panel._sliders) == chain.n
        drive = chain.n - 1 if name == "coupled_finger" else 1
        value = chain.midrange()[drive] + 0.1
        page.set_joint(drive, value)
        wait_until(lambda: page._arm.q[drive] == value)
        seen = page._layers[0]._context.seen
        poses = seen.tree.link_poses(page._arm.positions)
        np.testing.assert_allclose(poses[chain.tip], page._arm.tip, atol=1e-12)
        (table,) = [layer for layer in page._layers if type(layer).__name__ == "DHTableLayer"]
        wait_until(lambda: table._table is not None and table._table.content == NO_TABLE)


def test_the_page_says_why_it_draws_no_boundary():
    chain = coupled("palletizer")
    with pytest.raises(BadValueError, match="mimic joints rear_back, level") as error:
        section_view(chain)
    assert "joints of this arm follow others (mimic)" in why_no_section(chain, error.value)


@pytest.mark.parametrize("way", [JOINTS, LINE])
def test_the_motion_of_a_page_is_planned_in_drives(way):
    limits = {"acceleration": np.full(4, 8.0), "jerk": np.full(4, 80.0)}
    chain, start = replace(coupled("palletizer"), **limits), np.array([0.2, 0.4, 0.5, 0.3])
    goal = start + [0.1, 0.2, 0.1, 0.0]
    made = plan_between(chain, start, goal, way, "poly345")
    np.testing.assert_allclose(made.motion.q[[0, -1]], [start, goal], atol=1e-6)
    assert made.complete
