"""`robomech map` and `robomech plot-map`, as a user runs them."""

import os
import pty
import re
import signal
import subprocess
import sys

import numpy as np
import pytest

from robomech_ros.cli import main as cli
from robomech_ros.kinetostatics import load_reach_map, reach_map, uniform_turns
from robomech_ros.robots import load_robot
from robomech_ros.spatial import matrix_from_quaternion

ROBOMECH = (sys.executable, "-m", "robomech_ros.cli.main")
PUMA = ("map", "--robot", "puma560", "--length", "0.3")


def run(capfd, *arguments):
    code = cli.main(list(map(str, arguments)))
    captured = capfd.readouterr()
    return code, captured.out, captured.err


@pytest.mark.slow
def test_a_map_is_computed_told_and_drawn(tmp_path, capfd):
    place = {"cwd": tmp_path, "capture_output": True, "text": True, "timeout": 120, "check": False}
    box = ("--lower", "-0.9", "-0.9", "0", "--upper", "0.9", "0.9", "0.6", "--spacing", "0.3")
    made = subprocess.run([*ROBOMECH, *PUMA, *box, "--orientations", "10"], **place)
    assert (made.returncode, made.stderr) == (0, "")
    assert (
        "puma560, base_link to tool0: 7 x 7 x 3 points, 10 orientations, 1,470 poses" in made.stdout
    )
    assert re.search(r"poses reached +\d+\.\d%", made.stdout)
    found = load_reach_map(tmp_path / "map.npz", load_robot("puma560"))
    wanted = reach_map(
        load_robot("puma560"), [-0.9, -0.9, 0], [0.9, 0.9, 0.6], spacing=0.3,
        orientations=10, length=0.3,
    )  # fmt: skip
    assert found.cells.tobytes() == wanted.cells.tobytes()
    assert f"condition number  {wanted.best_condition_number:.4g} at best" in made.stdout
    assert f"reached    {(wanted.reached > 0).sum()} (" in made.stdout
    assert f", {(wanted.reached == 10).sum()} in all orientations" in made.stdout
    picture = tmp_path / "map.svg"
    drawn = run(capfd, "plot-map", tmp_path / "map.npz", "--output", picture)
    assert drawn == (0, f"{picture}: 147 of 147 points\n", "")
    assert "<svg" in picture.read_text(encoding="utf-8")


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_finished_and_says_so(tmp_path):
    file = tmp_path / "map.npz"
    command = [*ROBOMECH, *PUMA, "--shape", "60", "60", "60", "--output", str(file)]
    ours, theirs = pty.openpty()  # to a terminal the bar tells when points are finished
    terminal = {**os.environ, "TERM": "xterm", "COLUMNS": "100"}
    said = ""
    with subprocess.Popen(command, stderr=theirs, env=terminal) as process:
        os.close(theirs)
        begun = False
        while text := read(ours):
            said += text
            if not begun and re.search(r"[1-9]\d*/216000", said):
                begun = True
                process.send_signal(signal.SIGINT)
        process.wait(timeout=600)
    os.close(ours)
    assert process.returncode == 130
    found = load_reach_map(file)
    assert 0 < found.finished < 216_000
    assert f"interrupted; {found.finished:,} of 216,000 points are in" in said


def read(terminal):
    """Read what is there, empty when nobody can write any more."""
    try:
        return os.read(terminal, 4096).decode()
    except OSError:
        return ""


def test_orientations_can_be_told(capfd, tmp_path):
    file = tmp_path / "scara.npz"
    code, out, err = run(
        capfd, "map", "--robot", "scara", "--length", 0.3, "--output", file,
        "--lower", 0.2, -0.3, 0.2, "--upper", 0.6, 0.3, 0.3, "--shape", 3, 2, 2,
        "--about", 0, 0, 1, "--orientation", 1, 0, 0, 0, "--orientations", 4,
    )  # fmt: skip
    assert (code, err) == (0, "")
    assert "4 orientations, 48 poses" in out
    down = matrix_from_quaternion([1, 0, 0, 0])
    found = load_reach_map(file)
    assert np.allclose(found.request.orientations, uniform_turns(4, [0, 0, 1], down))
    assert found.share_reached > 0.0
    code, out, _ = run(
        capfd, "plot-map", file, "--axis", "z", "--at", 0.3, "--quantity", "condition",
        "--output", tmp_path / "map.png",
    )  # fmt: skip
    assert code == 0
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("map", "--robot", "puma"), "unknown robot 'puma' (did you mean 'puma560'?)"),
        ((*PUMA, "--lower", "0", "0", "nan", "--upper", "1", "1", "1"), "lower[2] is nan"),
        ((*PUMA, "--lower", "0", "2", "0", "--upper", "1", "1", "1"), "lower[1] (y) is 2.0"),
        ((*PUMA, "--upper", "1", "1", "1"), "--lower is None, expected both corners"),
        ((*PUMA, "--spacing", "0"), "spacing is 0.0, expected a positive distance"),
        ((*PUMA, "--spacing", "1e-6"), "bytes of memory, of which"),
        ((*PUMA, "--shape", "0", "1", "1"), "whole numbers of at least 1"),
        ((*PUMA, "--orientations", "-1"), "number of orientations is -1"),
        ((*PUMA, "--orientation", "0", "0", "0", "0"), "quaternion"),
        ((*PUMA, "--about", "0", "0", "0"), "axis"),
        ((*PUMA, "--workers", "0"), "workers is 0"),
        ((*PUMA, "--part", "all"), "part is 'all'"),
        ((*PUMA, "--output", "nowhere/map.npz"), "cannot be written: No such file or directory"),
        ((*PUMA, "--output", "map.csv"), "ends with .npz"),
        (("plot-map", "none.npz"), "none.npz: cannot be read: No such file or directory"),
        (("plot-map", "none.npz", "--output", "map.gif"), "ends with png, svg or pdf"),
    ],
)
def test_what_is_wrong_is_said(arguments, text, capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capfd, *arguments)
    assert (code, out) == (2, "")
    assert text in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_drawn_is_said(capfd, tmp_path):
    file = tmp_path / "map.npz"
    reach_map(load_robot("puma560"), [0, 0, 0], [0.5, 0.5, 0.5], shape=2, orientations=1,
              length=0.3, file=file)  # fmt: skip
    for more, text in (
        (("--quantity", "beauty"), "quantity is 'beauty', expected one of dexterity"),
        (("--axis", "w"), "axis is 'w', expected one of x, y, z"),
        (("--at", "0"), "at is 0.0, expected an axis as well"),
        (("--axis", "z", "--at", "9"), "expected a place in the grid: z from 0 to 0.5 m"),
        (("--output", "/nowhere/map.png"), "a file that can be written (No such file"),
    ):
        code, _, err = run(capfd, "plot-map", file, *more)
        assert code == 2
        assert text in err
