"""Contours of a platform on its page, by a client without a browser."""

import numpy as np
import pytest

pytest.importorskip("viser")

import msgspec.msgpack
from raw_client import Client, camera, send_value, wait_until

from robomech_ros.parallel import load_parallel
from robomech_ros.rvs import view
from robomech_ros.rvs.layers.platform_contours import PlatformContoursLayer


def opened(page, connection):
    connection.send(msgspec.msgpack.encode(camera()))
    wait_until(lambda: page._audience.commander is not None and page._panel is not None)
    return next(one for one in page._layers if isinstance(one, PlatformContoursLayer))


@pytest.mark.parametrize("name", ["planar_3rpr", "planar_3rrr", "sgp_6_3"])
def test_a_click_on_a_crossing_moves_the_platform_to_that_mode(name):
    robot = load_parallel(name)
    with view(name, port=0) as page, Client(page).connect() as connection:
        layer = opened(page, connection)
        platform = layer._context.platform
        drives, before = platform.values, platform.tip
        send_value(connection, layer._box._impl.uuid, True)
        wait_until(lambda: "<svg" in layer._view._plot.content)
        modes = robot.direct(drives).poses
        crossings = layer._equations.contours().all()
        # Modes of a symmetrical platform share a crossing, and differ in the third angle.
        ends = [layer._equations.solutions_at(*one.point) for one in crossings]
        assert sum(map(len, ends)) == len(modes) > 1
        layer._view._mark_all()
        text = f"{len(crossings)} crossings: {len(crossings)} assembly modes"
        wait_until(lambda: text in layer._view._text.content)
        poses = [layer._equations.pose(one[0]).real for one in ends]
        # The mode that the platform can take, and that is farthest from where it is.
        able = [k for k, T in enumerate(poses) if len(robot.mechanism.postures(T))]
        goal = max(able, key=lambda k: np.abs(poses[k] - before).max())
        x, y = crossings[goal].point
        send_value(connection, layer._view._estimate._impl.uuid, f"{x:.2f}, {y:.2f}")
        wait_until(lambda: np.abs(platform.tip - poses[goal]).max() < 1e-6)
        np.testing.assert_allclose(platform.values, drives, atol=1e-6)


def test_a_platform_without_contours_says_which_have_some():
    with view("hexapod", port=0) as page, Client(page).connect() as connection:
        layer = opened(page, connection)
        assert "contours" not in layer._context.offered
        assert "legs that end in pairs" in layer._folder._handles[-1].content
