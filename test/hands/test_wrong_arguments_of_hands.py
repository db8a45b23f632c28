"""Whatever is given to the functions of hands, they answer or raise an error of ours."""

import numpy as np
import pytest
from grasps import disc, on_sphere
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros import hands
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.hands import Contact, grasp_matrix, is_force_closed, load_hand

VALUES = (
    *WRONG_VALUES,
    [np.nan] * 3,
    [1e300] * 3,
    [np.inf] * 6,
    [1e300] * 6,
    np.zeros(9),
    [0, 1, 7],
    disc(3, 0.5),
    on_sphere(np.eye(3), 0.5),
)
HAND = load_hand("three_fingered")
GRASP = on_sphere(0.05 * np.eye(3), 0.5)


def calls():
    """Every function, one argument at a time."""
    q = np.full(9, 0.5)
    good = {
        "contacts": GRASP,
        "hand": HAND,
        "q": q,
        "rates": q,
        "twist": np.ones(6),
        "twist_rate": np.ones(6),
        "components": np.ones(9),
        "wrench": np.ones(6),
        "T": np.eye(4),
        "length": 1.0,
        "origin": np.zeros(3),
        "points": 0.05 * np.eye(3) + [0.0, 0.0, 0.08],
        "found": hands.grasp_postures(HAND, np.eye(4), GRASP),
    }
    found = {"load_hand": load_hand}
    found |= with_options(
        Contact, position=[0.0, 0.0, 1.0], normal=[0.0, 0.0, 1.0], model="soft", friction=0.5
    )
    for name in hands.__all__:
        function = getattr(hands, name)
        if name[0].islower() and name not in ("load_hand", "list_hands"):
            names = function.__code__.co_varnames[: function.__code__.co_argcount]
            more = function.__code__.co_kwonlyargcount
            names += function.__code__.co_varnames[len(names) : len(names) + more]
            found |= with_options(function, **{key: good[key] for key in names if key in good})
    return found


CALLS = calls()


@pytest.mark.parametrize("name", CALLS)
def test_everything_is_answered_or_refused(name):
    answered_or_refused(CALLS[name], VALUES)


@pytest.mark.parametrize("normal", [[0.0, 0.0, 0.0], [1e-12, 0.0, 0.0]])
def test_a_contact_without_normal(normal):
    with pytest.raises(BadValueError, match="normal of the contact"):
        Contact([0.0, 0.0, 0.0], normal, "point", 0.5)


def test_negative_friction_and_what_is_no_number():
    with pytest.raises(BadValueError, match=r"friction of the contact is -0\.1"):
        Contact([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], "point", -0.1)
    with pytest.raises(BadValueError, match="torsional"):
        Contact([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], "soft", 0.1, -0.1)
    with pytest.raises(NonFiniteError, match="friction"):
        Contact([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], "point", np.nan)
    with pytest.raises(NonFiniteError, match="position"):
        Contact([0.0, np.nan, 0.0], [1.0, 0.0, 0.0])
    with pytest.raises(BadValueError, match="frictionless, point"):
        Contact([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], "sticky", 0.1)


def test_no_contacts_and_contacts_of_two_kinds():
    with pytest.raises(WrongSizeError, match="contacts"):
        is_force_closed([])
    with pytest.raises(BadValueError, match="in the plane"):
        grasp_matrix([*GRASP, *disc(2, 0.5)], [0.0, 0.0, 0.0])
    assert not is_force_closed(GRASP[:1])
