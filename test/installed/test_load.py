"""A short load on the installed suite; `make load` makes long ones."""

import subprocess
import sys

import pytest

# A service of each node, an action, and a topic of each that moves the robot.
SOME = "solve_ik$|plan_joint|inverse_dynamics|/execute|/joint_trajectory|delta_twist"


@pytest.mark.timeout(900)
@pytest.mark.parametrize("only", [SOME, pytest.param("", marks=pytest.mark.long)], ids=len)
def test_calls_at_once_and_floods(repository, shell_environment, only):
    command = [sys.executable, str(repository / "test/load"), "--count", "20", "--seconds", "0.05"]
    command += ["--only", only]
    done = subprocess.run(
        command, env=shell_environment(), capture_output=True, text=True, timeout=880, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "solve_ik: 20 of 20" in done.stdout
