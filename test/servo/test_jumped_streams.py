"""A clock that steps while a servo drives: whoever hears of it first, the joints keep their limits.

Servo and controller leave out different times, by some milliseconds. Before, the controller took
what was in time as it was, and accelerated at up to 38 times the limits for these milliseconds.
"""

import pytest
from jumped_streams import JumpedStream, Listener
from test_late_streams import POSTURES, jog

# When the clock steps (s).
AT = 0.31
JOG = jog(0.8, 0, 0, 0, 0, 0)


@pytest.mark.parametrize(
    ("jump", "servo", "controller", "behind"),
    [
        (0.4, (-0.010, 0.002), (0.008, 0.006), 0.004),
        (0.4, (-0.004, 0.008), (-0.008, 0.002), 0.006),
        (-0.4, (-0.002, 0.008), (0.014, 0.000), 0.008),
        (-10.0, (0.000, 0.004), (0.006, 0.000), 0.004),
    ],
)
def test_no_step_of_the_clock_breaks_a_limit(jump, servo, controller, behind):
    (first, lost), (second, left_out) = servo, controller
    seen = JumpedStream(
        "puma560",
        POSTURES["puma560"],
        JOG,
        jump,
        Listener(jump, AT + first, lost),
        Listener(jump, AT + second, left_out, behind),
        seconds=0.5,
    )
    speed, change = seen.excess()
    assert speed <= 1.0 + 1e-6, f"velocity {speed} of its limit"
    assert change <= 1.0 + 1e-6, f"acceleration {change} of its limit"
