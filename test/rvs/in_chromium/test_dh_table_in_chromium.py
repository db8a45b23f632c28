"""The DH table in a real browser: a number is typed, and another robot is there."""

from browsing import IN_CHROMIUM, browser
from raw_client import wait_until

from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM
FOLDER = (
    "[...document.querySelectorAll('div')].find(d => d.children.length <= 2 && "
    "d.textContent === 'DH table')"
)
TABLE = "document.querySelector('[data-dh-table]')"
CELL = "document.querySelector('[data-dh=\"{name}\"]')"
BUTTON = "[...document.querySelectorAll('button')].find(b => b.innerText.trim() === '{label}')"


def mark(tab):
    """Mark the table that is there, to tell it from the next one."""
    tab.value(f"{TABLE}.dataset.old = 1")


def wait_for_next_table(tab):
    """Wait until another table has taken the place of the one that was marked."""
    tab.wait_for(f"{TABLE} && !{TABLE}.dataset.old")


def type_into(tab, name, text):
    """Type over a number of the table, leave it, and wait for the table that comes of it."""
    cell = CELL.format(name=name)
    # What is still folded away takes no focus.
    tab.wait_for(f"(c => {{ c.focus(); c.select(); return document.activeElement === c }})({cell})")
    mark(tab)
    tab.send("Input.insertText", text=text)
    tab.value(f"{cell}.blur()")
    wait_for_next_table(tab)


def test_a_number_typed_into_the_table_is_another_robot_and_wrong_ones_are_refused():
    with view("puma560", port=0) as page, browser(page.url) as tab:
        tab.wait_for("document.querySelector('[data-postures]')")
        tab.wait_for(FOLDER)
        tab.value(f"{FOLDER}.click()")
        first = page._arm.chain
        type_into(tab, "2 a", "0.65")
        wait_until(lambda: page._arm.chain.dh.a[1] == 0.65)
        wait_until(lambda: page._arm.study.postures)
        # The folder is open again, with the new number, and the ghosts are there.
        tab.wait_for(f"{CELL.format(name='2 a')}.value === '0.65'")
        tab.wait_for(
            "document.querySelectorAll('[data-posture]').length === "
            f"{len(page._arm.study.postures)}"
        )
        tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
        second = page._arm.chain
        type_into(tab, "3 b", "1e9")
        tab.wait_for("document.querySelector('[data-notice]').innerText.includes('1e+09')")
        tab.wait_for(f"{CELL.format(name='3 b')}.value === '0.15005'")
        assert page._arm.chain is second
        mark(tab)
        tab.value(f"{BUTTON.format(label='Reset robot')}.click()")
        wait_until(lambda: page._arm.chain is first)
        wait_for_next_table(tab)
        tab.wait_for(f"{CELL.format(name='2 a')}.value === '0.4318'")
        saved = tab.value("decodeURIComponent(document.querySelector('a[download]').href)")
        assert "name: puma560" in saved and "wrist_swivel" in saved
