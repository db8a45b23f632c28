"""Averages over the workspace, against closed forms and quadrature."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from robomech_ros.errors import BadValueError, MissingLimitsError
from robomech_ros.kinetostatics import condition_number, global_conditioning_index
from robomech_ros.robots import chain_from_dh, load_robot

QUARTER = 0.5 * math.pi
WRIST = chain_from_dh(a=[0.0] * 3, b=[0.0] * 3, alpha=[QUARTER, QUARTER, 0.0])


def planar_2r(first, second, **options):
    return chain_from_dh(a=[first, second], b=[0.0] * 2, alpha=[0.0] * 2, **options)


def agrees(index, wanted):
    """Within what the estimate says of itself, which must be small."""
    assert 0.0 < index.standard_error < 1e-3
    return abs(index - wanted) < 5.0 * index.standard_error


def test_orthogonal_wrist_has_the_index_of_its_closed_form():
    # kappa = sqrt((1 + c) / (1 - c)) and dW = |sin theta_5|, c = |cos theta_5|: the integral of
    # sqrt((1 - c) / (1 + c)) from 0 to 1.
    index = global_conditioning_index(WRIST, part="orientation")
    assert agrees(index, QUARTER - 1.0)


@pytest.mark.parametrize(("first", "second"), [(math.sqrt(2.0), 1.0), (1.0, 1.0), (0.3, 0.7)])
def test_planar_2r_has_the_index_of_its_closed_form(first, second):
    # By the Frobenius norm 1 / kappa = 2 |det J| / trace(J J^T), det J = l1 l2 sin theta_2.
    A, B = first**2 + 2.0 * second**2, 2.0 * first * second
    wanted = math.pi * first * second * (A - math.sqrt(A * A - B * B)) / B**2
    arm = planar_2r(first, second)
    assert agrees(global_conditioning_index(arm, part="position", norm="frobenius"), wanted)


def test_planar_2r_within_limits_is_what_quadrature_gives():
    arm = planar_2r(1.0, 0.7, limits={"lower": [-1.0, 0.3], "upper": [0.5, 1.9]})

    def reciprocal(angle):
        return 1.0 / condition_number(arm, [0.0, angle], part="position")

    above = quad(lambda t: math.sin(t) * reciprocal(t), 0.3, 1.9)[0]
    index = global_conditioning_index(arm, part="position")
    assert agrees(index, above / (math.cos(0.3) - math.cos(1.9)))
    whole = global_conditioning_index(arm, part="position", respect_limits=False)
    free = quad(lambda t: math.sin(t) * reciprocal(t), 0.0, math.pi, limit=200)[0] / 2.0
    assert agrees(whole, free)


def test_puma_is_conditioned_worse_on_average_than_at_best():
    puma = load_robot("puma560")
    both = global_conditioning_index(puma, length=0.283)
    assert both.length == 0.283
    assert 0.0 < both < 1.0 / 3.16
    assert 10.0 * both.standard_error < both


def test_it_is_the_same_in_every_call_and_its_error_shrinks():
    few, again, many = (
        global_conditioning_index(WRIST, part="orientation", postures=count)
        for count in (1 << 10, 1000, 1 << 15)
    )
    assert (few, few.standard_error) == (again, again.standard_error)
    assert (few.postures, many.postures) == (1 << 10, 1 << 15)
    assert many.standard_error < 0.2 * few.standard_error


@pytest.mark.parametrize("name", ["panda", "scara"])
def test_arms_with_more_or_fewer_joints_have_one(name):
    assert 0.0 < global_conditioning_index(load_robot(name), length=0.3, postures=1024) < 1.0


def test_what_is_wrong_is_said():
    with pytest.raises(BadValueError, match="postures is 1"):
        global_conditioning_index(WRIST, postures=1)
    with pytest.raises(BadValueError, match="regular in some posture as to its position"):
        global_conditioning_index(WRIST, part="position")
    with pytest.raises(BadValueError, match="norm is '1'"):
        global_conditioning_index(WRIST, norm="1")
    slide = chain_from_dh(a=[0.0, 1.0], b=[0.0, 0.0], alpha=[QUARTER, 0.0], types="PR")
    with pytest.raises(MissingLimitsError, match="no position limit for joint"):
        global_conditioning_index(slide, part="position")
    assert 0.0 < global_conditioning_index(load_robot("planar3r"), part="position") < 1.0
    assert np.isfinite(global_conditioning_index(planar_2r(1.0, 1.0), part="position"))
