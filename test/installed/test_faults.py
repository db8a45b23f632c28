"""Some faults in mid motion; `make faults` has all of them happen to every node."""

import subprocess
import sys

# One way of calling, of ending a process and of holding it up each.
CHOSEN = (
    "joint_trajectory_controller: kill -9: execute",
    "joint_trajectory_controller: SIGTERM: follow_joint_trajectory",
    "joint_trajectory_controller: SIGSTOP 1 s: topic",
    "trajectory_publisher: kill -9: execute",
    "joint_trajectory_controller: kill -9: gripper_cmd",
)


def test_faults_in_mid_motion(repository, shell_environment):
    command = [sys.executable, str(repository / "test/faults"), "--slack", "10"]
    command += ["--only", f"^({'|'.join(CHOSEN)})$"]
    done = subprocess.run(
        command, env=shell_environment(), capture_output=True, text=True, timeout=580, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{len(CHOSEN)} faults, 0 of them with something wrong" in done.stdout
