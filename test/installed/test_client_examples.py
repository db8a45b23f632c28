"""The scripts of examples/ that are clients, each a process beside one running suite."""

import re
import sys
from pathlib import Path

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot


def test_clients_of_the_suite(suite, bringup, outsider, output_of):
    chain = load_robot("puma560")
    examples = Path(__file__).resolve().parents[2] / "examples"

    def run(name):
        return output_of(sys.executable, examples / f"{name}.py", env=suite.environment)

    def still_at(accept):
        state = outsider.wait_for_joints(accept)
        return dict(zip(state.name, state.position, strict=True))

    with bringup("--robot", "puma560", "--in-one-process"):
        start = still_at(lambda q: set(q) == set(chain.joint_names))
        text = run("solve_ik_client")
        rows = [row.split(",") for row in re.findall(r"\[(.+)\]  shoulder-", text)]
        assert f"{len(rows)} solutions, provably all: True\n" in text
        assert len(rows) == 4
        for row in rows:
            tip = forward_kinematics(chain, [float(value) for value in row])[:3, 3]
            assert max(abs(tip - [0.6, 0.1, 0.4])) < 2e-3

        text = run("follow_joint_trajectory_client")
        assert text.endswith("arrived\n")
        still_at(lambda q: all(abs(q[name] - start[name] - 0.2) < 1e-3 for name in start))

        text = run("plan_and_execute_client")
        goal = dict(zip(chain.joint_names, [0.5, 0.8, -0.6, 0.4, 0.5, 0.3], strict=True))
        assert re.search(r"planned \d+ points, [\d.]+ s\narrived at ", text)
        still_at(lambda q: all(abs(q[name] - goal[name]) < 1e-3 for name in goal))
