"""Pictures of several quantities are written, and what does not fit is refused."""

import numpy as np
import pytest

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.panels import Panel, plot_panels


def test_a_picture_is_written_with_gaps_and_marks(tmp_path):
    pytest.importorskip("matplotlib")
    rising = Panel("position (m)", ("x", "y"), np.array([[0.0, 1.0], [np.nan, 2.0], [1.0, 3.0]]))
    still = Panel("momentum (N s)", ("both",), np.ones((3, 1)))
    times, path = np.arange(3.0), tmp_path / "panels.png"
    found = plot_panels(path, times, (rising, still), title="two", marks=[(1.0, "contact")])
    assert found.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(WrongSizeError, match=r"momentum \(N s\)"):
        plot_panels(path, times, (rising, still._replace(values=np.ones((2, 1)))))
