"""A short attack on the installed suite; `make fuzz` makes long ones."""

import subprocess
import sys


def test_random_requests_goals_messages_and_bytes(repository, shell_environment):
    command = [sys.executable, str(repository / "test/fuzz"), "--count", "400", "--seed", "1"]
    done = subprocess.run(
        command, env=shell_environment(), capture_output=True, text=True, timeout=280, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "requests answered, 0 not" in done.stdout
