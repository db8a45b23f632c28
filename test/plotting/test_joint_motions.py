"""Plots are written where they are asked for, and wrong input is refused."""

import sys

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.plotting.joint_motions import plot_motion
from robomech_ros.plotting.pictures import PlottingUnavailableError

TIMES = np.linspace(0.0, 1.0, 50)
Q = np.column_stack((TIMES**2, 1.0 - TIMES))
V = np.column_stack((2 * TIMES, -np.ones(50)))
A = np.column_stack((np.full(50, 2.0), np.zeros(50)))


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_a_motion_is_drawn(tmp_path, suffix):
    path = plot_motion(
        tmp_path / f"motion.{suffix}",
        ("turn", "slide"),
        TIMES,
        (Q, V, A),
        title="two joints",
        prismatic=(False, True),
        marks=((0.5, "half"),),
    )
    data = path.read_bytes()
    assert len(data) > 5000
    assert data.startswith({"png": b"\x89PNG", "svg": b"<?xml"}[suffix])


def test_positions_alone_will_do(tmp_path):
    assert plot_motion(str(tmp_path / "q.png"), "ab", TIMES, (Q,)).stat().st_size > 0


@pytest.mark.parametrize(
    ("curves", "error", "text"),
    [
        ((), BadValueError, "number of curves is 0"),
        ((Q, V, A, A, A), BadValueError, "number of curves is 5"),
        ((Q, V[:-1]), WrongSizeError, r"velocity has shape \(49, 2\), expected \(50, 2\)"),
    ],
)
def test_curves_that_do_not_fit(tmp_path, curves, error, text):
    with pytest.raises(error, match=text):
        plot_motion(tmp_path / "q.png", "ab", TIMES, curves)


def test_limits_are_drawn_where_they_are_finite(tmp_path):
    bounds = [(np.array([-1.0, -np.inf]), np.array([1.5, np.inf]))] * 4
    plain = plot_motion(tmp_path / "plain.svg", "ab", TIMES, (Q, V, A, A)).read_text()
    limited = plot_motion(tmp_path / "limits.svg", "ab", TIMES, (Q, V, A, A), limits=bounds)
    assert limited.read_text().count("stroke-dasharray") == plain.count("stroke-dasharray") + 8
    # Each curve has its own.
    bounds[1] = (np.full(2, -np.inf), np.full(2, np.inf))
    fewer = plot_motion(tmp_path / "fewer.svg", "ab", TIMES, (Q, V, A, A), limits=bounds)
    assert fewer.read_text().count("stroke-dasharray") == plain.count("stroke-dasharray") + 6
    with pytest.raises(WrongSizeError, match="limits has size 1, expected 2"):
        plot_motion(tmp_path / "no.svg", "ab", TIMES, (Q, V), limits=bounds[:1])
    with pytest.raises(WrongSizeError, match=r"position limits has shape \(1,\)"):
        plot_motion(tmp_path / "no.svg", "ab", TIMES, (Q,), limits=[(TIMES[:1], TIMES[:1])])


def test_without_matplotlib_the_way_to_get_it_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(PlottingUnavailableError, match="pip install matplotlib"):
        plot_motion(tmp_path / "q.png", "ab", TIMES, (Q,))
