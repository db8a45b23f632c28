"""Objects around an arm in a real browser: chosen by a click, and dragged by the mouse."""

import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from controls import pixel
from gizmo_mouse import GizmoMouse
from raw_client import wait_until
from world_cases import HERE, ROBOT, SCENE, world_layer

from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM
GIZMO = "/base/object"
TEXT = "document.querySelector('[data-world]').innerText"
STRUCK = "document.querySelectorAll('[data-posture] [data-contact]').length"


@pytest.fixture
def shown():
    """A page of an arm beside a wall, and a browser that shows it."""
    with view(ROBOT, port=0, scene=SCENE) as page, browser(page.url) as tab:
        page._ask("posture", lambda: page._arm.move_to(HERE))
        tab.wait_for("document.querySelector('[data-postures]')")
        tab.wait_for(f"__viserMutable.nodeRefFromName['{GIZMO}']")
        tab.wait_for(f"{TEXT}.includes(' m apart')")
        page.show("gizmo", False)
        tab.frames(5)
        yield page, tab, world_layer(page)


def test_an_object_is_chosen_by_a_click_and_dragged_into_postures(shown):
    page, tab, layer = shown
    world, before = page._arm.world, page._arm.world.objects["ball"].pose
    tab.click(*pixel(tab, layer._nodes[0]._drawn["ball"].frame.name))
    wait_until(lambda: layer._dragged == "ball")
    tab.wait_for(f"__viserMutable.nodeRefFromName['{GIZMO}'].visible")
    tab.frames(10)
    mouse = GizmoMouse(tab, GIZMO, 0.12, lambda: layer._held)
    x, y = mouse.drag(6, (20, 20))
    wait_until(lambda: not np.array_equal(world.objects["ball"].pose, before))
    mouse.release(x, y)
    # The wall is brought among the postures; the browser sees what that means.
    struck = tab.value(STRUCK)
    page._ask("wall", lambda: world.move("wall", page._arm.tip))
    tab.wait_for(f"{TEXT}.includes(' m deep') && {TEXT}.includes('wall')")
    tab.wait_for(f"{STRUCK} > {struck}")
    assert "contact, " in layer._nodes[1]._label.text
    count = sum(not world.scene.is_free(one.q) for one in page._arm.study.postures)
    tab.wait_for(f"{STRUCK} === {count}")
    row = "document.querySelector('[data-posture] [data-contact]').closest('tr')"
    assert "wall" in tab.value(f"{row}.innerText")
    assert tab.value(f"getComputedStyle({row}.querySelector('s')).textDecorationLine") == (
        "line-through"
    )
