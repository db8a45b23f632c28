"""A short attack on the installed suite; `make fuzz` makes long ones."""

import subprocess
import sys

import pytest

COUNTS = {"puma560": 100, "mecanum": 60, "phantomx": 60, "three_fingered": 60}


@pytest.mark.timeout(900)
@pytest.mark.parametrize("robot", COUNTS)
def test_random_requests_goals_messages_and_bytes(repository, shell_environment, robot):
    command = [sys.executable, str(repository / "test/fuzz"), "--seed", "1"]
    command += ["--robot", robot, "--count", str(COUNTS[robot])]
    done = subprocess.run(
        command, env=shell_environment(), capture_output=True, text=True, timeout=800, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "requests answered, 0 not" in done.stdout
