"""Pictures of postures: every one is drawn, and what cannot be drawn is refused."""

import re
import sys

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.plotting.pictures import PlottingUnavailableError
from robomech_ros.plotting.postures import _rows, _skeleton, plot_postures
from robomech_ros.robots import load_robot


@pytest.mark.parametrize("name", ["general6r", "puma560", "stanford", "scara", "panda"])
def test_links_hang_together_and_end_at_the_tip(name, random_chain):
    for chain in (load_robot(name), random_chain(3, 7)):
        q = np.clip(np.linspace(-1.0, 1.0, chain.n), chain.lower, chain.upper)
        arm = _skeleton(chain, q)
        np.testing.assert_allclose(arm.tip, forward_kinematics(chain, q), atol=1e-12)
        ends = [link[-1] for link in arm.links[:-1]]
        np.testing.assert_allclose(ends, [link[0] for link in arm.links[1:]], atol=1e-12)
        np.testing.assert_allclose(arm.links[-1][-1], arm.tip[:3, 3], atol=1e-12)
        for link, axis in zip(arm.links[1:], arm.axes, strict=True):
            along, across = np.diff(link, axis=0)
            np.testing.assert_allclose(np.cross(along, axis), 0.0, atol=1e-12)
            assert abs(across @ axis) < 1e-12


def test_the_eye_is_where_it_is_said_to_be():
    rows = _rows(0.5, 0.3)
    np.testing.assert_allclose(rows @ rows.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(rows) == pytest.approx(1.0)
    eye = [np.cos(0.3) * np.cos(0.5), np.cos(0.3) * np.sin(0.5), np.sin(0.3)]
    np.testing.assert_allclose(rows[2], eye, atol=1e-15)


def test_every_posture_has_its_panel(tmp_path):
    chain = load_robot("stanford")
    T = forward_kinematics(chain, [0.3, 0.4, 0.5, 0.2, 0.7, -0.3])
    q = inverse_kinematics(chain, T, respect_limits=False).q
    text = plot_postures(tmp_path / "all.svg", chain, q, title="one arm").read_text()
    # Each text is a comment above its glyphs.
    captions = re.findall("<!-- (.+) -->", text)
    assert captions.count("one arm") == 1
    assert [str(i + 1) for i in range(len(q))] == [c for c in captions if c.isdigit()]
    assert sum("m" in c and "°" in c for c in captions) == len(q)
    again = plot_postures(tmp_path / "one.png", chain, q[:1])
    assert again.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("q", "error", "text"),
    [
        (np.zeros(6), WrongSizeError, r"\(k, 6\)"),
        (np.zeros((2, 5)), WrongSizeError, r"\(k, 6\)"),
        (np.zeros((0, 6)), BadValueError, "number of postures is 0"),
        (np.zeros((65, 6)), BadValueError, "1 to 64"),
        (np.full((1, 6), np.nan), NonFiniteError, "nan"),
    ],
)
def test_postures_that_are_none(tmp_path, q, error, text):
    with pytest.raises(error, match=text):
        plot_postures(tmp_path / "no.png", load_robot("puma560"), q)
    assert not list(tmp_path.iterdir())


def test_without_matplotlib(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(PlottingUnavailableError, match="pip install matplotlib"):
        plot_postures(tmp_path / "q.png", load_robot("puma560"), np.zeros((1, 6)))
