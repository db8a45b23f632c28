"""Angles of a page in rad or in degrees."""

import math

import pytest

pytest.importorskip("viser")

from raw_client import send_value, slider, wait_until

from robomech_ros.rvs.page.units import Units


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("roll pitch yaw +3.142 +0.000 -1.571 rad", "roll pitch yaw +180.0 +0.0 -90.0 deg"),
        ("misses it by 0.5 m and 0.2 rad.", "misses it by 0.5 m and 11.5 deg."),
        (
            "joint 'x' is 7, expected -6.28319 to 6.28319 rad",
            "joint 'x' is 401.1, expected -360.000 to 360.000 deg",
        ),
        ("1.20 of 30 rad/s", "68.8 of 1718.9 deg/s"),
        ("3 mm, 0.34 mrad", "3 mm, 0.0195 deg"),
        ("at joint 3, 0.5 rad away", "at joint 3, 28.6 deg away"),
        ("border-radius:4px", "border-radius:4px"),
        ("2 radians, j2 rad, 1.5 m", "2 radians, j2 rad, 1.5 m"),
    ],
)
def test_the_angles_of_a_text_are_written_in_degrees(text, said):
    units = Units()
    assert units.text(text) == text
    units.degrees = True
    assert units.text(text) == said


def test_the_switch_changes_all_angles_of_a_page_and_moves_nothing(page, commander):
    box, first = page._panel._shown._boxes["degrees"], page._panel._sliders[0]
    send_value(commander, slider(page, 0), 0.5)
    wait_until(lambda: page._arm.q[0] == 0.5)
    q, summary = page._arm.q.copy(), page._stage._summary._handle
    assert " rad" in summary.content and (first.min, first.max) == (-2 * math.pi, 2 * math.pi)
    send_value(commander, box._impl.uuid, True)
    wait_until(lambda: first.max == pytest.approx(360.0))
    assert first._handle.value == pytest.approx(math.degrees(0.5)) and first.value == 0.5
    assert "-360.0 to 360.0 deg" in first.hint
    wait_until(lambda: " deg" in summary.content)
    assert " rad" not in summary.content
    wait_until(lambda: "(deg)" in page._stage._table.content)
    assert (page._arm.q == q).all()
    # What the page sends is in degrees now; so is what is refused.
    send_value(commander, slider(page, 0), 45.0)
    wait_until(lambda: page._arm.q[0] == pytest.approx(math.pi / 4))
    send_value(commander, slider(page, 0), 400.0)
    wait_until(lambda: "400" in page._stage._notice._handle.content)
    assert "expected -360.000 to 360.000 deg" in page._stage._notice._handle.content
    send_value(commander, box._impl.uuid, False)
    wait_until(lambda: first.max == pytest.approx(2 * math.pi))
    assert page._arm.q[0] == pytest.approx(math.pi / 4)
