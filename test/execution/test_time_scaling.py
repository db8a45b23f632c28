"""The pace changes without a step, and as fast as the acceleration limits allow."""

import numpy as np
import pytest
from execution_cases import wave

from robomech_ros.execution.time_scaling import constant_pace, pace_change, paced_step

LIMIT = np.full(2, 8.0)


def test_scaling_is_continuous():
    curve = wave().curve
    scaling = pace_change(curve, 2.0, 0.4, 1.0, 0.2, LIMIT)
    times = np.linspace(2.0, 4.0, 4001)
    places = np.array([scaling.place(time) for time in times])
    paces = np.array([scaling.pace_at(time) for time in times])
    assert places[0] == pytest.approx(0.4)
    assert (np.diff(paces) <= 1e-12).all()
    np.testing.assert_allclose(np.gradient(places, times)[1:-1], paces[1:-1], atol=0.02)
    assert scaling.place(1.0) == pytest.approx(0.4)


def test_steps_of_any_length_follow_the_same_change():
    curve = wave().curve
    scaling = pace_change(curve, 0.0, 0.4, 1.0, 0.2, LIMIT)
    for count in (1, 7, 400):
        place, pace = 0.4, 1.0
        for _ in range(count):
            place, pace, _ = paced_step(curve, place, pace, 0.2, 0.7 / count, LIMIT)
        assert place == pytest.approx(scaling.place(0.7), abs=2e-3)
        assert pace == pytest.approx(scaling.pace_at(0.7), abs=2e-2)


def test_no_time_changes_the_pace_at_once_by_the_same_rate():
    place, pace, rate = paced_step(wave().curve, 0.4, 1.0, 0.2, 0.0, LIMIT)
    assert (place, pace) == (0.4, 1.0)
    assert rate == pytest.approx(paced_step(wave().curve, 0.4, 1.0, 0.2, 1e-6, LIMIT)[2], rel=1e-3)
    assert rate < -1.0


def test_a_constant_pace_goes_on_for_ever():
    scaling = constant_pace(1.0, 0.0, 0.25)
    assert (scaling.place(5.0), scaling.pace_at(5.0), scaling.pace) == (1.0, 0.25, 0.25)
