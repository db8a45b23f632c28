"""Pictures of walks are written, and what does not fit is refused."""

import numpy as np
import pytest

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.walks import plot_walk

LEGS = ("a", "b", "c")


def picture(path, m=5, margins=5, footholds=3):
    way = np.zeros((m, 2))
    stood = [np.array([[k, 0.0], [k, 1.0]]) for k in range(footholds)]
    times, values = np.arange(5.0), np.full(margins, 0.1)
    return plot_walk(path, LEGS, times, way, stood, values, bound=0.01, planned=way)


def test_a_picture_is_written(tmp_path):
    pytest.importorskip("matplotlib")
    assert picture(tmp_path / "walk.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("wrong", [{"m": 4}, {"margins": 4}, {"footholds": 2}])
def test_what_does_not_fit_is_refused(tmp_path, wrong):
    with pytest.raises(WrongSizeError):
        picture(tmp_path / "walk.png", **wrong)
