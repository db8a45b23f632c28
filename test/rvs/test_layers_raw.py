"""What a raw client may send to controls of the layers: refused or harmless, server alive."""

import math

import numpy as np
import pytest

pytest.importorskip("viser")

from raw_client import inside_limits, send_value, slider, wait_until


def control(page, label):
    """A control of the browser that commands, by its label."""
    for layer in page._layers:
        folder = getattr(layer, "_folder", None)
        for handle in getattr(folder, "_handles", ()):
            if getattr(handle, "label", None) == label:
                return handle
    raise KeyError(label)


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
    assert page._layers[0]._switches.part == "translation"
    node = page._layers[0]._nodes["velocity"]
    wait_until(lambda: np.allclose(node.position, page._arm.tip[:3, 3], atol=1e-6))


def test_numbers_are_not_looked_for_before_they_are_shown(page, commander):
    layer = page._layers[0]
    alive(page, commander)
    assert not layer._asked_for_facts and not layer._nodes
    send_value(commander, control(page, "numbers")._impl.uuid, True)
    wait_until(lambda: layer._next is not None)
    assert "next singularity" in layer._table.content


def test_the_best_posture_is_taken_as_soon_as_it_is_known(page, commander):
    layer = page._layers[0]
    send_value(commander, control(page, "Go to the least condition number")._impl.uuid, True)
    wait_until(lambda: layer._facts is not None)
    wait_until(lambda: np.array_equal(page._arm.q, layer._facts.best.q))
