"""The folder "Understand" in a real browser."""

import numpy as np
import pytest
from browsing import IN_CHROMIUM, browser
from controls import checkbox
from raw_client import wait_until

from robomech_ros.kinetostatics import characteristic_length, condition_number
from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM
BUTTON = "[...document.querySelectorAll('button')].find(b => b.innerText.trim() === '{label}')"
FOLDER = (
    "[...document.querySelectorAll('div')].find(d => d.children.length <= 2 && "
    "d.textContent === '{label}')"
)
TABLE = "document.querySelector('[data-understand]')"


@pytest.fixture(scope="module")
def shown():
    """A page of a UR5e with the folder open, and a browser that shows it."""
    with view("ur5e", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-postures]')")
        tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
        tab.wait_for(FOLDER.format(label="Understand"))
        tab.value(f"{FOLDER.format(label='Understand')}.click()")
        tab.wait_for(TABLE)
        yield page, tab


def tick(tab, label, checked=True):
    """Tick a checkbox, or not."""
    box = checkbox(label)
    tab.wait_for(box)
    if tab.value(f"{box}.checked") != checked:
        tab.value(f"{box}.click()")
    tab.wait_for(f"{box}.checked === {str(checked).lower()}")


def ellipsoid(tab):
    """Half axes and place of the ellipsoid of velocities as it is drawn."""
    node = "__viserMutable.nodeRefFromName['/base/velocity_ellipsoid']"
    tab.wait_for(node)
    return np.array(
        tab.value(f"(() => {{ const o = {node}; o.updateWorldMatrix(true, false);"
                  "return [o.scale.toArray(), o.position.toArray()]; })()")
    )  # fmt: skip


def test_the_numbers_come_and_follow_the_arm(shown):
    page, tab = shown
    tick(tab, "numbers")
    tab.wait_for(f"{TABLE}.innerText.includes('characteristic length')")
    tab.wait_for(f"{TABLE}.innerText.includes('next singularity')")
    before = tab.value(f"{TABLE}.innerText")
    assert "0.2039 m" in before and "1.874" in before
    page.set_joint(2, 0.0)
    tab.wait_for(f"{TABLE}.innerText.includes('elbow')")
    tab.wait_for(f"{TABLE}.innerText.includes('infinite')")
    page.home()
    tab.wait_for(f"!{TABLE}.innerText.includes('infinite')")


def test_the_ellipsoid_is_drawn_at_the_tip_and_follows(shown):
    page, tab = shown
    tick(tab, "velocity ellipsoid")
    for value in (0.4, -0.4):
        page.set_joint(0, value)
        wait_until(lambda v=value: page._arm.q[0] == v)
        tip = page._arm.tip[:3, 3]
        wait_until(lambda p=tip: np.allclose(ellipsoid(tab)[1], p, atol=1e-4))
    assert tab.value(f"{TABLE}.innerText.includes('m/s at joint rates of norm 1')")
    tick(tab, "velocity ellipsoid", False)
    tab.wait_for("!__viserMutable.nodeRefFromName['/base/velocity_ellipsoid']?.visible")


def test_the_button_goes_to_the_least_condition_number(shown):
    page, tab = shown
    tick(tab, "numbers")
    tab.value(f"{BUTTON.format(label='Go to the least condition number')}.click()")
    length = float(characteristic_length(page._arm.chain))
    wait_until(lambda: condition_number(page._arm.chain, page._arm.q, length=length) < 1.8741)
    tab.wait_for(f"{TABLE}.innerText.includes('condition number here\\t1.874')")
