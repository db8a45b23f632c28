"""The scripts of examples/ that need no ROS: they run, and print what is true.

Those with rclpy run beside the installed suite, in test/installed/test_client_examples.py.
"""

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import PROFILES

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))


@pytest.fixture
def output_of(tmp_path, monkeypatch, capsys):
    """Run an example in an empty folder and return what it prints."""
    monkeypatch.chdir(tmp_path)

    def run(name: str, *arguments: str) -> str:
        script = str(EXAMPLES / f"{name}.py")
        monkeypatch.setattr(sys, "argv", [script, *arguments])
        runpy.run_path(script, run_name="__main__")
        return capsys.readouterr().out

    return run


def numbers(pattern: str, text: str) -> list[float]:
    """Return the number that each match of a pattern holds in its group."""
    return [float(found) for found in re.findall(pattern, text, re.MULTILINE)]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_every_script_is_short_says_how_to_run_it_and_is_listed(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 60
    assert f"python examples/{path.name}" in text.split('"""')[1]
    assert f"[`{path.name}`](./{path.name})" in (EXAMPLES / "README.md").read_text(encoding="utf-8")


def test_every_script_is_run_by_a_test():
    clients = ROOT / "test" / "installed" / "test_client_examples.py"
    for path in SCRIPTS:
        needs_ros = "import rclpy" in path.read_text(encoding="utf-8")
        tests = (clients if needs_ros else Path(__file__)).read_text(encoding="utf-8")
        assert f'"{path.stem}"' in tests, path.name


def test_load_any_arm(output_of):
    text = output_of("load_any_arm")
    assert numbers(r"(\d+) joints", text) == [6, 2, 3]
    assert re.findall(r"solver: (\S+)", text) == ["three-parallel", "short", "short"]
    assert "joints: pan, tilt\n    tip at mid-range: [0.  0.  0.4] m" in text


def test_add_a_gripper(output_of, tmp_path):
    text = output_of("add_a_gripper")
    assert "the arm: 7 joints from panda_link0 to panda_hand_tcp" in text
    assert "joint panda_finger_joint2 follows panda_finger_joint1" in text
    assert numbers(r": (\S+) m wide", text) == [0.0, 0.04, 0.08]
    assert load_robot(tmp_path / "panda_with_hand.urdf", tip="panda_hand_tcp").n == 7


def test_all_solutions(output_of):
    text = output_of("all_solutions")
    chain = load_robot("puma560")
    target = forward_kinematics(chain, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2])
    inside = len(inverse_kinematics(chain, target).q)
    assert numbers(r"^(\d+) solutions", text) == [inside] == [text.count("wrist-")]
    assert numbers(r"without joint limits: (\d+)", text) == [8]
    reasons = re.findall(r": ([A-Z_]+): ", text)
    assert reasons == ["OUT_OF_REACH", "LIMITS_EXCLUDE_ALL", "ORIENTATION_UNREACHABLE"]


def test_continuous_path(output_of):
    text = output_of("continuous_path")
    whole, part = numbers(r"(\d+) % followed", text)
    assert whole == 100.0 > part > 0.0
    assert re.findall(r"^    ([A-Z]+): .*joint '(\w+)' would leave", text, re.MULTILINE) == [
        ("LIMIT", "shoulder")
    ]
    assert max(numbers(r"off the line by (\S+)", text)) <= 1e-7
    last = [np.array(row.split(), float) for row in re.findall(r"q = \[(.+?)\]", text)][3]
    chain = load_robot("puma560")
    before, after = forward_kinematics(chain, [[0.1, -0.5, 0.4, 0.3, 0.8, 0.2], last])
    assert np.abs((before - after)[:3, 3] - [0.0, 0.0, 0.1]).max() < 2e-3
    assert min(numbers(r"rest: (\S+) s", text)) > 0.1


def test_singularity(output_of):
    text = output_of("singularity")
    assert re.findall(r"rank (\d), condition number (\S+),", text) == [("6", "4.886"), ("5", "inf")]
    assert text.count("lost: ") == text.count("the tip rests") == 1
    assert numbers(r"(\S+) rad away", text) == [0.8]  # the wrist straight


def test_workspace_picture(output_of, tmp_path):
    text = output_of("workspace_picture", "picture.svg")
    assert "</svg>" in (tmp_path / "picture.svg").read_text(encoding="utf-8")
    assert numbers(r": (\d) postures", text) == [2, 0]
    inside, outside = numbers(r"([+-]\d\S+) m from", text)
    assert inside > 0.0 > outside


def test_an_option_is_no_name_of_a_picture(tmp_path):
    script = str(EXAMPLES / "workspace_picture.py")
    done = subprocess.run(
        [sys.executable, script, "--bogus"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "unrecognized arguments: --bogus" in done.stderr
    assert not list(tmp_path.iterdir())


def test_profiles(output_of):
    text = output_of("profiles")
    rows = [line.split() for line in text.splitlines() if line.split()[0] in PROFILES]
    assert [row[0] for row in rows] == list(PROFILES)
    for row in rows:
        velocity, acceleration, jerk = map(float, row[2:])
        if row[0] == "trapezoidal":  # its acceleration steps
            assert jerk == np.inf, row
            jerk = 0.0
        assert 0.999 <= max(velocity, acceleration, jerk) <= 1.0, row
    assert "t = 1.5 s: q[0] = 0.500 rad, 0.000 rad/s" in text


def test_spline_through_points(output_of):
    text = output_of("spline_through_points")
    assert "t = 1.0 s: q = [ 0.3 -0.2  0.5  0.2  0.1  0. ]" in text
    assert text.count("ok: True") == 3
    assert numbers(r"moves at (\S+)", text)[::3] == [0.0, 0.0]
    cubic, ruckig, optimal = numbers(r"^\w+: (\S+) s,", text)
    assert cubic > ruckig > optimal


def test_time_optimal_torques(output_of):
    text = output_of("time_optimal_torques")
    used = numbers(r"(\S+) % of its torque", text)
    assert len(used) == 6
    assert 99.0 < max(used) <= 100.0
    assert numbers(r"during (\d+) %", text)[0] >= 95


def test_inverse_dynamics_three_ways(output_of):
    text = output_of("inverse_dynamics_three_ways")
    rows = re.findall(r"\[(.+)\] N m", text)
    assert len(rows) == 3
    torques = np.array([row.split() for row in rows], float)
    assert np.abs(torques - torques[0]).max() < 1e-3 < np.abs(torques).min()
    assert numbers(r"difference: (\S+)", text)[0] < 1e-10
    assert numbers(r"at most (\S+)", text)[0] < 1e-12
