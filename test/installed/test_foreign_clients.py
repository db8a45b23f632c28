"""Ten foreign clients of the installed move_group at once; `make clients` lets them work longer."""

import subprocess
import sys

import pytest


@pytest.mark.timeout(600)
@pytest.mark.long  # seventeen processes, beside which nothing else keeps its time
@pytest.mark.parametrize("seconds", [8, 180])
def test_clients_plan_and_move_while_objects_come_and_go(repository, shell_environment, seconds):
    pytest.importorskip("coal")
    command = [sys.executable, str(repository / "test/foreign_clients"), "--seconds", str(seconds)]
    done = subprocess.run(
        command, env=shell_environment(), capture_output=True, text=True, timeout=580, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "motions: " in done.stdout and ": 0 contacts" in done.stdout
