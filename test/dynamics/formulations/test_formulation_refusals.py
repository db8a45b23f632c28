"""Whatever is given to the formulations, they answer or raise an error of ours, and never warn."""

import inspect
import warnings

import numpy as np
import pytest
from wrong_values import WRONG_VALUES

from robomech_ros import dynamics
from robomech_ros.dynamics.symbolic.closed_forms import symbolic_model
from robomech_ros.errors import RobomechError
from robomech_ros.robots import load_robot

ARM = load_robot("planar3r")
Q, QD, QDD, TAU = np.random.default_rng(0).uniform(-1, 1, (4, 30, 3))
BODIES = dynamics.body_parameters(ARM)
VALUES = (
    *WRONG_VALUES,
    [None] * 3,
    [np.nan] * 3,
    [1e300] * 3,
    np.empty((0, 3)),
    np.zeros((30, 3)),
    np.full((30, 3), 1e300),
    np.full((30, 3), np.inf),
    np.full((4, 10), 1e300),
    np.zeros((4, 10)),
)
STATE = {"chain": ARM, "q": Q[0], "qd": QD[0]}
CALLS = {
    **{
        name: STATE | {"qdd": QDD[0]}
        for name in dynamics.__all__
        if name.startswith("inverse_dynamics_by")
    },
    **{
        name: STATE | {"tau": TAU[0]}
        for name in dynamics.__all__
        if name.startswith("forward_dynamics_by")
    },
    "natural_orthogonal_complement": STATE,
    "partial_velocities": {"chain": ARM, "q": Q[0]},
    "mass_matrix_gradient": {"chain": ARM, "q": Q[0]},
    "christoffel_symbols": {"chain": ARM, "q": Q[0]},
    "excitation": {"chain": ARM, "q": Q, "qd": QD, "qdd": QDD},
    "identify": {"chain": ARM, "q": Q, "qd": QD, "qdd": QDD, "tau": TAU},
    "pseudo_inertia": {"parameters": BODIES},
    "is_physically_consistent": {"parameters": BODIES},
    "nearest_consistent": {"parameters": BODIES},
    "bodies_from_parameters": {"parameters": BODIES},
    "operation_counts": {"algorithm": "inverse: newton-euler", "n": 6},
}


def refused_or_answered(function, good):
    for name in inspect.signature(function).parameters:
        for value in VALUES:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                try:
                    function(**(good | {name: value}))
                except RobomechError as error:
                    assert str(error), (name, value)


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    refused_or_answered(getattr(dynamics, name), CALLS[name])


def test_closed_forms_refuse_wrong_arguments():
    refused_or_answered(symbolic_model, {"chain": ARM})
