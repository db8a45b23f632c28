"""A short load on the installed suite; `make load` makes long ones."""

import subprocess
import sys

import pytest


@pytest.mark.timeout(900)
def test_calls_at_once_and_floods(repository, shell_environment):
    command = [sys.executable, str(repository / "test/load"), "--count", "20", "--seconds", "0.05"]
    done = subprocess.run(
        command, env=shell_environment(), capture_output=True, text=True, timeout=880, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "solve_ik: 20 of 20" in done.stdout
