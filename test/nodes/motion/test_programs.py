"""Programs of moves and waits, from a YAML file."""

import numpy as np
import pytest
from drivers import ROBOT
from std_srvs.srv import Trigger

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.nodes.trajectory_publisher.program import read_program
from robomech_ros.robots import SemanticDescription, load_robot

CHAIN = load_robot(ROBOT)
HOME = CHAIN.home()
NAMED = SemanticDescription(ROBOT)
ABOVE, DOWN = HOME + 0.1, HOME + np.array([0.1, 0.2, 0.1, 0.1, 0.1, 0.1])
STEPS = """
  - {move: above, velocity_scale: 0.9}
  - {move: down, profile: ruckig}
  - {wait: 0.05}
"""


def written(folder, cycles=2, steps=STEPS, more=""):
    text = f"cycles: {cycles}\npostures:\n  above: {ABOVE.tolist()}\n  down: {DOWN.tolist()}\n"
    place = folder / "program.yaml"
    place.write_text(f"{text}{more}steps:{steps}", encoding="utf-8")
    return str(place)


def trigger(arm, service):
    answer = arm.graph.call(Trigger, f"trajectory_publisher/{service}", Trigger.Request())
    return answer.success, answer.message


def started(suite, path):
    arm = suite(robot_description=ROBOT, program=path)
    arm.until(lambda: arm.states)
    # The publisher may not have heard of the joints yet.
    tries = (trigger(arm, "run_program") for _ in range(1000))
    success, said = next(found for found in tries if "no present state" not in found[1])
    assert success, said
    return arm, said


@pytest.mark.slow
def test_two_cycles(suite, tmp_path):
    arm, said = started(suite, written(tmp_path))
    assert said == "3 steps, 2 cycles"
    value = arm.value("program", lambda status: "program done" in str(status.values))
    assert value == "program done: 2 cycles"
    seen = np.array([state.position for state in arm.states])
    at_down = np.abs(seen - DOWN).max(axis=1) < 1e-6
    at_above = np.abs(seen - ABOVE).max(axis=1) < 1e-6
    assert np.diff(at_down.astype(int)).clip(0).sum() == 2
    assert np.diff(at_above.astype(int)).clip(0).sum() == 2
    assert arm.value("arrived") == "4"


def test_until_cancelled(suite, tmp_path):
    arm, said = started(suite, written(tmp_path, cycles=0))
    assert said == "3 steps, cycles until cancelled"
    assert trigger(arm, "run_program")[1].startswith("something is being executed already")
    arm.until(lambda: np.abs(arm.position - DOWN).max() < 1e-6)
    assert trigger(arm, "pause")[0]
    arm.until(lambda: not arm.velocity.any())
    assert trigger(arm, "resume")[0]
    arm.until(lambda: np.abs(arm.position - ABOVE).max() < 1e-6)
    assert trigger(arm, "cancel")[0]
    arm.until(lambda: not arm.velocity.any())
    value = arm.value("program", lambda status: "program cancelled" in str(status.values))
    assert value == "program cancelled by the service cancel"


def test_without_program_or_robot(suite, tmp_path):
    arm = suite(with_controller=False)
    assert trigger(arm, "run_program") == (
        False,
        "the parameter program is '', expected the path of a YAML file",
    )


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"steps": "\n  - {move: up}"}, "step 1: no posture 'up'; there are above, down, home"),
        ({"steps": "\n  - {jump: up}"}, "step 1: unknown key 'jump'; allowed: move, profile"),
        ({"steps": "\n  - {wait: -1}"}, "step 1: wait is -1, expected a number from 0"),
        ({"steps": "\n  - {wait: 1}"}, "no step moves"),
        ({"steps": " []"}, "steps is no list with at least one step"),
        ({"steps": "\n  - {move: down, duration: 0}"}, "duration is 0, expected a number above 0"),
        ({"steps": "\n  - {move: down, profile: magic}"}, "profile is 'magic', expected one of"),
        ({"cycles": -1}, "cycles is -1, expected a whole number"),
        ({"more": "  odd: [1.0]\n"}, "posture 'odd': expected 6 positions, of waist"),
        ({"more": f"  far: {[9.0] * 6}\n"}, "posture 'far': joint 'waist' is 9.0, expected"),
        ({"more": f"  nan: {['.nan'] * 6}\n".replace("'", "")}, "posture 'nan': joint 'waist'"),
    ],
)
def test_what_cannot_be(tmp_path, options, text):
    with pytest.raises(RobotDescriptionError, match=r"program '.*program.yaml'") as caught:
        read_program(written(tmp_path, **options), CHAIN, NAMED)
    assert text in str(caught.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(RobotDescriptionError, match="not readable"):
        read_program(str(tmp_path / "none.yaml"), CHAIN, NAMED)
