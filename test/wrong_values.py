"""Argument values with which tests call every function, to see it answered or rejected."""

import inspect
import warnings

import numpy as np

from robomech_ros.errors import RobomechError

__all__ = ["WRONG_VALUES", "answered_or_refused", "with_options"]

# Wrong for nearly all arguments; tests add arrays of the shapes that they ask for.
WRONG_VALUES = (
    None,
    True,
    "",
    "x",
    b"x",
    -1,
    0,
    1.5,
    np.nan,
    np.inf,
    1e300,
    1e-300,
    10**400,
    2 + 3j,
    object(),
    int,
    {},
    {"a": 1},
    {1, 2},
    [],
    [None],
    ["a"],
    [[1, 2], [3]],
    np.array(3.0),
    np.zeros((2, 2, 2)),
    np.zeros((4, 4)),
    np.full((4, 4), np.nan),
    np.full((4, 4), 1e300),
)


def with_options(function, /, *given, **good):
    """Calls of a function with each of its arguments by name replaced.

    Those that are ``given`` by their place stay as they are.
    """
    parameters = list(inspect.signature(function).parameters.values())[len(given) :]
    return {
        f"{function.__name__}.{one.name}": lambda value, name=one.name: function(
            *given, **(good | {name: value})
        )
        for one in parameters
        if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)
    }


def answered_or_refused(call, values):
    """Return each value in turn to a call, which must answer it or raise an error of ours.

    Returns the texts of the errors.
    """
    texts = []
    for value in values:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                call(value)
            except RobomechError as error:
                assert str(error), value
                texts.append(str(error))
    return texts
