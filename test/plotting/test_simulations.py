"""The picture of a simulated motion, and the command that draws it."""

import re

import numpy as np
import pytest

from robomech_ros.cli.main import main
from robomech_ros.dynamics import inverse_dynamics, potential_energy, simulate
from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.simulations import plot_simulation
from robomech_ros.robots import load_robot

DOWN = ["--gravity", "0", "-9.81", "0"]


def printed(capsys):
    """Return the duration, the largest torque, work, heat and the error of the balance."""
    text = capsys.readouterr().out
    numbers = re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e[-+]\d+)?(?= [sJ]|;)", text)
    return [float(one) for one in numbers]


def test_an_arm_that_falls_and_one_that_moves_are_drawn(tmp_path, capsys):
    arm, gravity = load_robot("planar3r"), [0.0, -9.81, 0.0]
    fall = tmp_path / "fall.png"
    start = ["--joints", "0.3", "-0.7", "1.1"]
    options = ["--duration", "0.4", *DOWN, "--output", str(fall)]
    assert main(["plot-simulation", "planar3r", *start, *options]) == 0
    assert fall.read_bytes().startswith(b"\x89PNG")
    _, torque, work, heat, drift = printed(capsys)
    assert torque == work == heat == 0.0 and drift < 1e-6
    move, goal = tmp_path / "move.svg", ["--goal", "0.8", "0.1", "0.5"]
    options = ["--duration", "1.0", *DOWN, "--output", str(move)]
    assert main(["plot-simulation", "planar3r", *start, *goal, *options]) == 0
    drawn = move.read_text(encoding="utf-8")
    assert drawn.startswith("<?xml")
    _, torque, work, _, _ = printed(capsys)
    # From rest to rest, work is the gain of potential energy; peaks are those of the polynomial.
    ends = [potential_energy(arm, q, gravity=gravity) for q in ([0.3, -0.7, 1.1], [0.8, 0.1, 0.5])]
    assert work == pytest.approx(ends[1] - ends[0], rel=1e-3)
    u, way = np.linspace(0.0, 1.0, 401)[:, None], np.array([0.5, 0.8, -0.6])
    q = [0.3, -0.7, 1.1] + way * (35 * u**4 - 84 * u**5 + 70 * u**6 - 20 * u**7)
    qd = way * 140 * u**3 * (1 - u) ** 3
    qdd = way * 420 * u**2 * (1 - u) ** 2 * (1 - 2 * u)
    peak = np.abs(inverse_dynamics(arm, q, qd, qdd, gravity=gravity)).max()
    assert torque == pytest.approx(peak, rel=1e-3)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("--output", "a.gif"), "png, svg or pdf"),
        (("--torques", "1.0"), "--torques has size 1, expected 3, one for each of"),
        (("--duration", "-1"), "duration is -1.0"),
        (("--gravity", "0", "0", "nan"), "nan"),
    ],
)
def test_bad_requests_are_refused(tmp_path, capsys, monkeypatch, options, text):
    monkeypatch.chdir(tmp_path)
    assert main(["plot-simulation", "planar3r", *options]) == 2
    assert text in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_torques_of_another_number_of_joints_are_refused(tmp_path):
    arm = load_robot("planar3r")
    run = simulate(arm, np.zeros(3), np.zeros(3), None, 0.01, times=[0.0, 0.01])
    with pytest.raises(WrongSizeError, match=r"torques has shape \(2, 2\), expected \(2, 3\)"):
        plot_simulation(tmp_path / "a.png", arm, run, np.zeros((2, 2)))
