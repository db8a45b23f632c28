"""Pictures of ways on the ground: what is drawn, and what is refused."""

import numpy as np
import pytest

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting import drives
from robomech_ros.plotting.drives import plot_paths

WANTED = np.random.default_rng(1).normal(size=(30, 2))
DRIVEN = np.random.default_rng(2).normal(size=(40, 3))


def test_ways_are_drawn_beside_each_other(tmp_path):
    path = plot_paths(
        tmp_path / "ways.svg", ("square", "eight"), [WANTED] * 2, [DRIVEN] * 2, title="a cart"
    )
    text = path.read_text(encoding="utf-8")
    for words in ("a cart", "square", "eight", "wanted", "driven", "heading", "x (m)", "y (m)"):
        assert f"<!-- {words} -->" in text


def test_headings_are_drawn_as_they_are(monkeypatch):
    figures = []
    monkeypatch.setattr(drives, "save", lambda figure, path, title: figures.append(figure))
    plot_paths("ways.svg", ("square",), [WANTED], [DRIVEN])
    lines = [line.get_xydata() for line in figures[0].axes[0].lines if "orange" in line.get_color()]
    lines = [line for line in lines if len(line)]
    assert len(lines) > 5
    for begin, end in lines:
        (heading,) = DRIVEN[(DRIVEN[:, :2] == begin).all(axis=1), 2]
        along, across = end - begin
        assert np.cos(np.arctan2(across, along) - heading) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("wanted", "driven"),
    [
        ([WANTED], [DRIVEN, DRIVEN]),
        ([WANTED, WANTED], [DRIVEN]),
        ([WANTED, DRIVEN], [DRIVEN, DRIVEN]),
        ([WANTED, WANTED], [DRIVEN, DRIVEN[:0]]),
    ],
)
def test_ways_that_do_not_fit_are_refused(tmp_path, wanted, driven):
    with pytest.raises(WrongSizeError):
        plot_paths(tmp_path / "ways.png", ("square", "eight"), wanted, driven)
