"""All blocks of doc/tutorial.md but the set-up in their order, and clients of other pages."""

import os
import re
import shlex
import subprocess
import sys

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot

pytest.importorskip("pymoveit2")

READY = {"pan": 0.8, "lift": 0.5, "elbow": 1.4, "roll": 0.0, "bend": 1.24, "swivel": 0.0}


def blocks(page):
    """Return heading, language and text of each block after the set-up."""
    found, heading = [], ""
    for title, language, text in re.findall(
        r"^## (.+?)$|^```(sh|python|py)\n(.*?)^```", page, re.DOTALL | re.MULTILINE
    ):
        heading = title or heading
        if language and heading != "Set-up":
            found.append((heading, language, text))
    return found


@pytest.mark.timeout(900)
def test_every_block_runs_in_order(suite, bringup, outsider, repository, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(repository / "examples")
    path = f"{suite.executables}{os.pathsep}{suite.environment['PATH']}"
    arm = load_robot(repository / "examples" / "my_arm.urdf")

    def run(language, text):
        command = ["bash", "-ec", text] if language == "sh" else [sys.executable, "-c", text]
        environment = {**suite.environment, "PATH": path}
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=200, check=False
        )
        assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
        return done.stdout

    def at_rest():
        """Return the positions of the joints."""
        found = outsider.wait_for_joints(lambda q: True)
        while np.abs(found.velocity).max() > 1e-9:
            found = outsider.wait_for_joints(lambda q: True)
        return dict(zip(found.name, found.position, strict=True))

    def tip():
        """The pose of the tool."""
        q = at_rest()
        return forward_kinematics(arm, [q[name] for name in arm.joint_names])

    def is_at(wanted):
        q = at_rest()
        return all(abs(q[name] - value) < 1e-3 for name, value in wanted.items())

    page = (repository / "doc" / "tutorial.md").read_text(encoding="utf-8")
    before, rest = [], blocks(page)
    while not rest[0][2].startswith("robomech bringup"):
        before.append(rest.pop(0))
    for _, language, text in before:
        output = run(language, text)
    assert output.count("[") == 5  # four postures
    with bringup(*shlex.split(rest.pop(0)[2])[2:], "--in-one-process"):
        (_, language, text), plan, line, jog, gripper, obstacle, client = rest
        assert run(language, text).count("- positions:") == 4
        run(*plan[1:])
        assert is_at(READY)
        assert (tmp_path / "plan.png").stat().st_size > 10_000
        above = tip()
        run(*line[1:])
        below = tip()
        np.testing.assert_allclose(below[:3, 3] - above[:3, 3], [0, 0, -0.1], atol=1e-3)
        moved = np.zeros(3)
        while moved[2] < 0.005:  # on a busy machine a second may pass before the first step
            run(*jog[1:])
            moved = tip()[:3, 3] - below[:3, 3]
        assert moved[2] < 0.06
        assert np.abs(moved[:2]).max() < 1e-3
        assert run(*gripper[1:]) == "gripper: 0.08 m wide\ngripper: 0.03 m wide\n"
        assert is_at({"grip": 0.015})
        assert run(*obstacle[1:]).startswith("success: true\n")
        assert is_at({**READY, "pan": -0.8})
        text = (tmp_path / "around.yaml").read_text(encoding="utf-8")
        assert text.count("positions:") > 2
        assert run(*client[1:]) == "arrived\n"
        target = np.diag([-1.0, 1.0, -1.0, 1.0])
        target[:3, 3] = 0.4, 0.3, 0.3
        np.testing.assert_allclose(tip(), target, atol=1e-3)
        for name in ("moveit", "interfaces"):
            text = (repository / "doc" / f"{name}.md").read_text(encoding="utf-8")
            (client,) = re.findall(r"^```py\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
            run("py", client)
        assert is_at({**READY, "pan": -0.8})
