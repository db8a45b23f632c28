"""Planar arms by twists of three numbers."""

import numpy as np
import pytest
from formulation_arms import golden_planar, states

from robomech_ros.dynamics import (
    coriolis_matrix,
    mass_matrix,
    natural_orthogonal_complement,
    planar_orthogonal_complement,
)
from robomech_ros.errors import BadValueError
from robomech_ros.robots import Body, chain_from_dh, load_robot

SLIDING = chain_from_dh(
    [0.4, 0.0, 0.3], [0.0, 0.0, 0.0], [np.pi / 2, -np.pi / 2, 0.0], types="RPR",
    bodies=[
        Body(m, [0.1, 0.02 * m, 0.03], np.diag([0.02, 0.03, 0.02 + 0.005 * m])) for m in (3, 2, 1)
    ],
)  # fmt: skip


def test_golden_mass_matrix_and_torques(golden):
    case = golden("dynamics_planar3r")
    model = planar_orthogonal_complement(golden_planar(case), case["q"], case["qd"])
    assert model.T.shape == (9, 3) and model.M.shape[-2:] == (9, 9)
    np.testing.assert_allclose(model.generalised_inertia, case["M"], atol=1e-12)
    coriolis = model.coupling @ np.asarray(case["qd"])
    np.testing.assert_allclose(coriolis, [-0.1376232267, -0.4150273106, 0.1116769677], atol=1e-9)


@pytest.mark.parametrize("chain", [load_robot("planar3r"), SLIDING], ids=["planar3r", "sliding"])
def test_three_numbers_are_as_good_as_six(chain):
    q, qd, _ = states(chain, 200, 3)
    planar = planar_orthogonal_complement(chain, q, qd)
    spatial = natural_orthogonal_complement(chain, q, qd)
    for name in ("generalised_inertia", "coupling"):
        given, expected = getattr(planar, name), getattr(spatial, name)
        np.testing.assert_allclose(given, expected, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(planar.generalised_inertia, mass_matrix(chain, q), atol=1e-11)
    bias = (planar.coupling @ qd[..., None])[..., 0]
    expected = (coriolis_matrix(chain, q, qd) @ qd[..., None])[..., 0]
    np.testing.assert_allclose(bias, expected, atol=1e-10)


def test_an_arm_in_space_is_refused():
    with pytest.raises(BadValueError, match="joint"):
        planar_orthogonal_complement(load_robot("puma560"), np.zeros(6), np.zeros(6))
