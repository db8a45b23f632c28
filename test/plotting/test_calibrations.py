"""Pictures of calibrations: what is drawn, and what is refused."""

import numpy as np
import pytest

from robomech_ros.errors import WrongSizeError
from robomech_ros.plotting.calibrations import plot_calibration

ERRORS = np.linspace(1e-3, 2e-3, 18).reshape(3, 6)
COVARIANCES = np.array([np.eye(6) * k * 1e-6 for k in (3.0, 2.0, 1.0)])
RESIDUALS = np.full((6, 2), 1e-3)


@pytest.mark.parametrize("wrong", [False, True])
def test_a_picture_is_written(tmp_path, wrong):
    inlier = np.ones(6, bool)
    inlier[2] = not wrong
    path = plot_calibration(
        tmp_path / "new" / "camera.svg",
        (4, 5, 6),
        ERRORS,
        COVARIANCES,
        residuals=RESIDUALS,
        inlier=inlier,
        title="a camera",
    )
    text = path.read_text(encoding="utf-8")
    assert ("<!-- left out -->" in text) == wrong
    for words in ("a camera", "position (m)", "rotation (rad)", "truth", "z (mm)"):
        assert f"<!-- {words} -->" in text


@pytest.mark.parametrize(
    ("errors", "covariances", "residuals"),
    [
        (ERRORS[:2], COVARIANCES, RESIDUALS),
        (ERRORS, COVARIANCES[:, :3], RESIDUALS),
        (ERRORS, COVARIANCES, RESIDUALS[:5]),
        (ERRORS, COVARIANCES, RESIDUALS[:, :1]),
    ],
)
def test_shapes_that_do_not_fit_are_refused(tmp_path, errors, covariances, residuals):
    with pytest.raises(WrongSizeError):
        plot_calibration(
            tmp_path / "camera.png",
            (4, 5, 6),
            errors,
            covariances,
            residuals=residuals,
            inlier=np.ones(6, bool),
        )
