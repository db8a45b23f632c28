"""Raw messages to controls of the layers: rejected or harmless, server alive."""

import math
import threading

import numpy as np
import pytest

pytest.importorskip("viser")

from raw_client import PATIENCE, inside_limits, send_value, slider, wait_until

from robomech_ros.robots import load_description
from robomech_ros.rvs.model.arms.dh_editing import table_of
from robomech_ros.rvs.model.arms.dh_frames import dh_frames
from robomech_ros.rvs.page.robot_nodes import FADED


def control(page, label):
    """A control of the browser that commands, by its label, once it is there."""
    found = []

    def is_there():
        folders = [getattr(layer, "_folder", None) for layer in page._layers]
        handles = [one for folder in folders for one in getattr(folder, "_handles", ())]
        # A control that does nothing yet is still being made.
        made = [one for one in handles if hasattr(one, "_impl") and one._impl.update_cb]
        found.extend(one for one in made if getattr(one, "label", None) == label)
        return found

    wait_until(is_there)
    return found[0]


def understand(page):
    """The layer "Understand" of a page."""
    return next(one for one in page._layers if type(one).__name__ == "AnalysisLayer")


def alive(page, commander, joint=5):
    """The next request is done, in its turn."""
    value = float(page._arm.q[joint]) + 0.0625
    send_value(commander, slider(page, joint), value)
    wait_until(lambda: abs(page._arm.q[joint] - value) < 1e-9)
    assert inside_limits(page)


@pytest.mark.parametrize("value", ["nonsense", math.nan, True, 7, ["translation"], ""])
def test_an_ellipsoid_of_what_is_none_is_refused(page, commander, value):
    send_value(commander, control(page, "velocity ellipsoid")._impl.uuid, True)
    send_value(commander, control(page, "ellipsoids of")._impl.uuid, value)
    alive(page, commander)
    assert understand(page)._saved["part"] == "translation"
    wait_until(lambda: "velocity" in understand(page)._nodes)
    node = understand(page)._nodes["velocity"]
    wait_until(lambda: np.allclose(node.position, page._arm.tip[:3, 3], atol=1e-6))


def test_numbers_are_not_looked_for_before_they_are_shown(page, commander):
    layer = understand(page)
    alive(page, commander)
    assert not layer._asked_for_facts and not layer._nodes
    send_value(commander, control(page, "numbers")._impl.uuid, True)
    wait_until(lambda: "next singularity" in layer._table.content)


def test_the_best_posture_is_taken_as_soon_as_it_is_known(page, commander):
    layer = understand(page)
    send_value(commander, control(page, "Go to the least condition number")._impl.uuid, True)
    wait_until(lambda: layer._facts is not None)
    wait_until(lambda: np.array_equal(page._arm.q, layer._facts.best.q))


def test_dh_frames_follow_the_arm_and_go(page, commander):
    layer = next(one for one in page._layers if type(one).__name__ == "DHTableLayer")
    switch = control(page, "DH frames")
    assert not layer._nodes._lines
    send_value(commander, switch._impl.uuid, True)
    wait_until(lambda: "normals" in layer._nodes._lines)
    alive(page, commander)
    expected = dh_frames(table_of(page._arm.chain), page._arm.q, layer._context.seen.reach)
    lines, labels = layer._nodes._lines, layer._nodes._labels
    wait_until(lambda: np.allclose(lines["axes"].points, expected.axes, atol=1e-6))
    assert {one.text for one in labels if one.visible} == {*expected.names}
    bodies = [node for _, node, _ in page._stage._robot._bodies]
    assert {node.opacity for node in bodies} == {FADED}
    send_value(commander, switch._impl.uuid, False)
    wait_until(lambda: not any(one.visible for one in (*lines.values(), *labels)))
    assert FADED not in {node.opacity for node in bodies}
    alive(page, commander)


def test_a_dh_number_changed_is_another_robot_solved_at_once_and_reset_brings_it_back(
    page, commander
):
    first, field = page._arm.chain, control(page, "Change DH")
    q = page._arm.q
    send_value(commander, field._impl.uuid, "2 a 0.6")
    wait_until(lambda: page._panel is not None and page._arm.chain is not first)
    chain = page._arm.chain
    assert chain.dh.a[1] == 0.6 and first.dh.a[1] != 0.6
    np.testing.assert_array_equal(page._arm.q, q)
    assert sum(posture.is_here for posture in page._arm.study.postures) == 1
    send_value(commander, control(page, "Reset robot")._impl.uuid, True)
    wait_until(lambda: page._arm.chain is first)
    wait_until(lambda: page._panel is not None)
    alive(page, commander)


def test_numbers_of_many_cells_typed_at_once_are_all_taken(page, commander):
    field, busy, heard = control(page, "Change DH"), threading.Event(), []
    first = page._arm.chain
    field.on_update(lambda event: heard.append(field.value))
    # While the page is busy all of them come, and each of the robots that they make is another.
    page._worker.submit("busy", lambda: busy.wait(PATIENCE))
    changes = [f"{k} {parameter} 0" for k in range(1, 7) for parameter in "ab"]
    for text in changes:
        send_value(commander, field._impl.uuid, text)
    wait_until(lambda: len(heard) == len(changes))
    busy.set()
    wait_until(lambda: not np.any([table_of(page._arm.chain).a, table_of(page._arm.chain).b]))
    assert page._arm.chain is not first


def test_a_number_typed_for_a_robot_that_is_gone_changes_no_other(page, commander):
    field, busy, heard = control(page, "Change DH"), threading.Event(), []
    field.on_update(lambda event: heard.append(field.value))
    page._worker.submit("busy", lambda: busy.wait(PATIENCE))
    robot = load_description("iiwa14")
    page.replace(robot, robot.chain())
    send_value(commander, field._impl.uuid, "2 a 0.6")
    wait_until(lambda: heard)
    busy.set()
    wait_until(lambda: page._arm.chain.n == 7 and page._panel is not None)
    alive(page, commander)
    assert page._arm.chain.name == robot.name


@pytest.mark.parametrize(
    "text", ["2 a 1e7", "2 a nan", "9 a 0.5", "a", "'; drop", "2 alpha 1e999", 7, True]
)
def test_a_dh_number_that_is_none_is_refused_and_the_robot_stays(page, commander, text):
    chain = page._arm.chain
    send_value(commander, control(page, "Change DH")._impl.uuid, text)
    wait_until(lambda: "Refused" in page._stage._notice.content)
    assert page._arm.chain is chain
    alive(page, commander)
