"""Programs of moves and waits, from a YAML file."""

import os
from pathlib import Path

import numpy as np
import pytest
from drivers import ROBOT, Driver
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.nodes.trajectory_publisher.program import read_program
from robomech_ros.robots import SemanticDescription, load_description, load_robot, load_srdf

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


SRDF = """<robot name="puma560">
  <group name="arm"><chain base_link="base_link" tip_link="tool0"/></group>
  {}
</robot>"""


def srdf(**states):
    """Make an SRDF with these postures of the arm, rad."""
    text = ""
    for name, places in states.items():
        joints = zip(CHAIN.joint_names, places, strict=True)
        values = "".join(f'<joint name="{joint}" value="{at}"/>' for joint, at in joints)
        text += f'<group_state name="{name}" group="arm">{values}</group_state>'
    return SRDF.format(text)


def test_a_program_moves_to_named_states_of_an_srdf(suite, tmp_path):
    steps = "\n  - {move: up}\n  - {move: above}\n  - {move: home}"
    semantic = srdf(home=HOME - 0.1, up=HOME + 0.05)
    arm, said = started(
        lambda **options: suite(robot_description_semantic=semantic, **options),
        written(tmp_path, cycles=1, steps=steps),
    )
    assert said == "3 steps, 1 cycle"
    arm.until(lambda: np.abs(arm.position - (HOME - 0.1)).max() < 1e-6)
    seen = np.array([state.position for state in arm.states])
    for place in (HOME + 0.05, ABOVE):
        assert np.abs(seen - place).max(axis=1).min() < 1e-6


def test_the_robot_begins_at_home_of_the_srdf_and_a_topic_comes_too_late_for_that(graph):
    semantic = srdf(home=HOME - 0.1)
    first = Driver(graph, graph.start, robot_description_semantic=semantic)
    first.until(lambda: first.states)
    np.testing.assert_allclose(first.position, HOME - 0.1, atol=1e-12)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    topic = "late/robot_description_semantic"
    graph.client.create_publisher(String, topic, latched).publish(String(data=semantic))
    second = Driver(graph, graph.start, namespace="late")
    second.until(lambda: second.states)
    np.testing.assert_allclose(second.position, HOME, atol=1e-12)


def test_a_posture_out_of_reach_is_refused_when_a_program_moves_there(tmp_path):
    far = HOME + np.array([0, 0, 0, 0, 9.0, 0])
    known = load_srdf(srdf(far=far), load_description(ROBOT))
    with pytest.raises(RobotDescriptionError) as caught:
        read_program(written(tmp_path, steps="\n  - {move: far}"), CHAIN, known)
    assert "step 1: state 'far' of group 'arm': joint '" in str(caught.value)
    assert "outside its limits" in str(caught.value)
    # What the program says itself goes before it.
    more = f"  far: {DOWN.tolist()}\n"
    path = written(tmp_path, steps="\n  - {move: far}", more=more)
    assert read_program(path, CHAIN, known).steps[0].positions == tuple(DOWN)


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
        ({"more": f"  low: {[-9.0] * 6}\n"}, "posture 'low': joint 'waist' is -9.0, expected"),
        ({"more": f"  nan: {['.nan'] * 6}\n".replace("'", "")}, "posture 'nan': joint 'waist'"),
    ],
)
def test_what_cannot_be(tmp_path, options, text):
    with pytest.raises(RobotDescriptionError, match=r"program '.*program.yaml'") as caught:
        read_program(Path(written(tmp_path, **options)), CHAIN, NAMED)
    assert text in str(caught.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(RobotDescriptionError, match="not readable"):
        read_program(tmp_path / "none.yaml", CHAIN, NAMED)


def test_nobody_waits_for_a_pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    with pytest.raises(RobotDescriptionError, match="not readable: not a regular file"):
        read_program(tmp_path / "pipe.yaml", CHAIN, NAMED)


@pytest.mark.parametrize(
    "text",
    [
        "root:x:0:0:the secret of root:/root:/bin/bash\nbin:x:1:1:the secret:/bin\n",
        "the secret: of root\n",
        "steps: the secret\n",
        "steps: [{move: the secret}]\n",
        "steps: [{wait: the secret}]\n",
        "steps: [{move: home, profile: the secret}]\n",
        "steps: [{move: home, duration: the secret}]\n",
        "steps: [{move: home}]\ncycles: the secret\n",
        "steps: [{move: a}]\npostures: {the secret: 3}\n",
        "steps: [{move: a}]\npostures: {a: [the secret, 1, 1, 1, 1, 1]}\n",
        "the secret: 1\nthe secret: 2\n",
        "&secret_of_root a: *secret_of_root\n",
        "%TAG !s! the secret\n--- !s!x\n",
        "'the secret\n",
        "- the secret\n",
    ],
)
def test_no_error_repeats_what_stands_in_a_file(tmp_path, text):
    path = tmp_path / "file"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RobotDescriptionError) as caught:
        read_program(path, CHAIN, NAMED)
    assert "secret" not in str(caught.value).removeprefix(f"program '{path}'")


def set_program(arm, value):
    parameter = Parameter("program", value=value).to_parameter_msg()
    request = SetParameters.Request(parameters=[parameter])
    answer = arm.graph.call(SetParameters, "trajectory_publisher/set_parameters", request)
    return answer.results[0].successful, answer.results[0].reason


def test_another_file_only_from_the_folder(suite, tmp_path):
    folder = tmp_path / "programs"
    folder.mkdir()
    written(folder)
    (tmp_path / "secret.yaml").write_text("steps: [{move: home}]")
    (folder / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    (folder / "circle.yaml").symlink_to("circle.yaml")
    arm = suite(with_controller=False, robot_description=ROBOT, program_folder=str(folder))
    assert set_program(arm, "program.yaml") == (True, "")
    outside = (str(tmp_path / "secret.yaml"), "../secret.yaml", "link.yaml", "/dev/zero")
    for name in outside:
        done, reason = set_program(arm, name)
        assert not done
        assert "allowed is the name of a file in program_folder" in reason
    for name in ("none.yaml", "circle.yaml", "."):
        set_program(arm, name)
        assert not trigger(arm, "run_program")[0]


def test_without_a_folder_the_program_is_fixed_at_start(suite, tmp_path):
    path = written(tmp_path)
    arm = suite(with_controller=False, program=path)
    done, reason = set_program(arm, "/etc/passwd")
    assert not done
    assert "allowed is what was given at start, as there is no program_folder" in reason
    assert set_program(arm, path) == (True, "")


def test_others_are_served_while_a_long_program_is_planned(suite, tmp_path):
    moves = "".join(
        f"\n  - {{move: {name}, velocity_scale: 0.{900 + k}}}"
        for k in range(500)
        for name in ("above", "down")
    )
    arm = suite(robot_description=ROBOT, program=written(tmp_path, steps=f"{moves}\n"))
    arm.until(lambda: arm.states)

    def cancelled():
        waiting = arm.graph.start_call(Trigger, "trajectory_publisher/run_program", request)
        while not waiting.done():
            trigger(arm, "cancel")
        return arm.graph.wait_for(waiting).message

    request = Trigger.Request()
    tries = (cancelled() for _ in range(1000))
    said = next(text for text in tries if "no present state" not in text)
    assert said == "program cancelled by the service cancel"
    before = arm.position
    assert not arm.velocity.any()
    np.testing.assert_array_equal(before, HOME)
