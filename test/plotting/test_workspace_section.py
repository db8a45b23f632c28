"""The picture of a workspace, and the command that draws it."""

import json
import sys

import pytest

from robomech_ros.cli.main import main
from robomech_ros.kinetostatics import workspace_boundary
from robomech_ros.plotting.pictures import PlottingUnavailableError
from robomech_ros.plotting.workspace_section import plot_workspace
from robomech_ros.robots import load_robot


def test_the_command_draws_and_writes_numbers(tmp_path, capsys):
    picture, numbers = tmp_path / "puma.png", tmp_path / "puma.json"
    options = ["--output", str(picture), "--json", str(numbers)]
    assert main(["plot-workspace", "puma560", *options]) == 0
    assert "2 nodes" in capsys.readouterr().out
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert len(json.loads(numbers.read_text())["nodes"]) == 2


def test_bad_requests_are_refused(tmp_path, capsys):
    assert main(["plot-workspace", "puma560", "--output", str(tmp_path / "puma.gif")]) == 2
    assert "png, svg or pdf" in capsys.readouterr().err
    assert main(["plot-workspace", "ur5e", "--output", str(tmp_path / "ur5e.png")]) == 2
    assert "joints that place a point" in capsys.readouterr().err


def test_without_matplotlib_it_says_what_to_install(tmp_path, monkeypatch):
    space = workspace_boundary(load_robot("scara"))
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(PlottingUnavailableError, match="pip install matplotlib"):
        plot_workspace(tmp_path / "w.png", space)
