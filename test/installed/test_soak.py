"""A short soak of the installed suite; `make soak` makes long ones."""

import subprocess
import sys

import pytest


@pytest.mark.long
@pytest.mark.timeout(900)
def test_a_short_soak_leaves_nothing_behind(repository, shell_environment):
    options = ("--minutes", "1", "--first", "0.2", "--rounds", "2", "--most", "60")
    command = [sys.executable, str(repository / "test/soak"), *options]
    done = subprocess.run(
        command, env=shell_environment(), capture_output=True, text=True, timeout=800, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "requests answered, 0 not" in done.stdout
