"""The eye in a real browser: what is seen at first, and by the button."""

import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from controls import button, press
from raw_client import wait_until

from robomech_ros.rvs import view
from robomech_ros.rvs.layers.camera import shown_points
from robomech_ros.rvs.model.camera import visible_points

pytestmark = IN_CHROMIUM
TIP = "__viserMutable.nodeRefFromName['/base/target']"


def places(tab, points):
    """Return the image coordinates of points in the root, from -1 to 1 both ways."""
    script = f"""(() => {{
        const v = __viserMutable;
        const root = v.nodeRefFromName['/base'].parent, c = v.camera;
        root.updateWorldMatrix(true, false); c.updateMatrixWorld();
        return {points.tolist()}.map(at => {{
            const p = {TIP}.position.clone().set(...at).applyMatrix4(root.matrixWorld).project(c);
            return [p.x, p.y]; }}); }})()"""
    return np.array(tab.value(script))


def fills(tab, points):
    """Whether points are all in the picture, and fill it in one direction."""
    at = np.abs(places(tab, points)).max(axis=0)
    return at.max() < 1.0 and at.max() > 0.75


def robot_share(tab, page):
    """Share of the picture, in its wider direction, that the bodies of the robot take."""
    place = page._layers[0]._context
    at = places(tab, visible_points(place.seen, [place.moved.positions]))
    return float(np.ptp(at, axis=0).max()) / 2.0


KINDS = ("panda", "ur5e", "hexapod", "delta", "phantomx", "mecanum", "three_fingered")


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_of_robot_fills_the_picture_at_first_and_by_the_button(name):
    with view(name, port=0) as page, browser(page.url) as tab:
        tab.wait_for(TIP)
        # Ghosts and gizmo are in the picture, too, and may be larger than the robot.
        wait_until(lambda: robot_share(tab, page) > 0.4)
        client = next(iter(page._server.viser.get_clients().values()))
        client.camera.position = 5.0 * client.camera.position
        wait_until(lambda: robot_share(tab, page) < 0.3)
        press(tab, button("Fit view"))
        wait_until(lambda: robot_share(tab, page) > 0.4)


def test_the_robot_fills_the_picture_at_first_and_by_the_button():
    with view("puma560", port=0) as page:
        camera = next(one for one in page._layers if type(one).__name__ == "CameraLayer")
        with browser(page.url) as tab:
            tab.wait_for(TIP)
            wait_until(lambda: fills(tab, shown_points(camera._context)))
            q = page._arm.q + [1.5, -0.8, 0.6, 0.0, 0.5, 0.0]
            page._ask("posture", lambda: page._arm.move_to(q))
            wait_until(lambda: np.array_equal(page._arm.q, q))
            client = next(iter(page._server.viser.get_clients().values()))
            client.camera.position = 4.0 * client.camera.position
            wait_until(lambda: not fills(tab, shown_points(camera._context)))
            press(tab, button("Fit view"))
            wait_until(lambda: fills(tab, shown_points(camera._context)))
