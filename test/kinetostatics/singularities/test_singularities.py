"""Singular postures: what is lost there, their names, the factored determinant, the nearest one."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinetostatics import (
    characteristic_length,
    condition_number,
    jacobian,
    manipulability,
    nearest_singular_posture,
    self_motion_curve,
    singularity_report,
)
from robomech_ros.robots import SerialChain, chain_from_dh, load_robot

LENGTH = 0.3
QUARTER = np.pi / 2
DECOUPLED = ["irb120", "m1013", "puma560", "rv4fr", "stanford", "ur5e", "ur10e", "ur20"]
# A posture at every kind of singularity, all else being general.
NAMED = [
    ("puma560", [0.3, 0.4, 0.5, 0.2, 0.0, 0.6], ("wrist",)),
    ("puma560", [0.3, 0.4, 0.5, 0.2, np.pi, 0.6], ("wrist",)),
    ("puma560", [0.3, 0.4, np.pi / 2 + np.arctan2(0.0203, 0.4331), 0.2, 0.7, 0.6], ("elbow",)),
    ("ur5e", [0.3, -1.0, 0.9, 0.2, 0.0, 0.6], ("wrist",)),
    ("ur5e", [0.3, -1.0, 0.0, 0.2, 0.7, 0.6], ("elbow",)),
    ("scara", [0.3, 0.0, 0.1, 0.2], ("elbow",)),
    ("planar3r", [0.2, 0.0, 0.0], ("elbow",)),
    ("iiwa14", [0.2, 0.3, 0.4, 0.0, 0.5, 0.6, 0.7], ("elbow",)),
    ("iiwa14", [0.2, 0.0, QUARTER, 0.8, 0.5, 0.6, 0.7], ("shoulder",)),
    ("iiwa14", [0.2, 0.3, 0.4, 0.8, QUARTER, 0.0, 0.7], ("wrist",)),
    ("stanford", [0.2, 0.3, 0.4, 0.1, 0.0, 0.2], ("wrist",)),
]


def shoulder_singular(robot, q):
    """Turn joint 2 until the shoulder's factor vanishes."""
    chain, q = load_robot(robot), np.array(q)

    def factor(angle):
        q[1] = angle
        return singularity_report(chain, q, length=LENGTH).factors["shoulder"]

    from scipy.optimize import brentq

    grid = np.linspace(-3, 3, 61)
    signs = np.sign([factor(angle) for angle in grid])
    k = int(np.flatnonzero(np.diff(signs))[0])
    q[1] = brentq(factor, grid[k], grid[k + 1], xtol=1e-15)
    return q


@pytest.mark.parametrize(("robot", "q", "kinds"), NAMED)
def test_named_singularities(robot, q, kinds):
    chain = load_robot(robot)
    report = singularity_report(chain, q, length=LENGTH)
    assert report.kinds == kinds and report.singular
    assert report.rank == min(6, chain.n) - 1
    assert np.isinf([report.condition_number, report.normalised_condition_number]).all()
    assert report.manipulability == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("robot", ["puma560", "ur5e"])
def test_the_shoulder(robot):
    q = shoulder_singular(robot, [0.3, 0.0, 0.9, 0.2, 0.7, 0.6])
    assert singularity_report(load_robot(robot), q, length=LENGTH).kinds == ("shoulder",)


@pytest.mark.parametrize(("robot", "q", "kinds"), NAMED)
def test_what_is_lost_and_what_is_free(robot, q, kinds):
    chain = load_robot(robot)
    report, J = singularity_report(chain, q, length=LENGTH), jacobian(chain, q)
    scale = np.repeat((1.0, 1.0 / LENGTH), 3)
    lost = report.lost_directions * scale
    assert len(lost) == 1
    np.testing.assert_allclose(lost @ lost.T, np.eye(1), atol=1e-12)
    np.testing.assert_allclose(lost @ (J * scale[:, None]), 0.0, atol=1e-6)
    wrenches = report.idle_wrenches
    assert len(wrenches) == 6 - report.rank
    np.testing.assert_allclose(wrenches @ J, 0.0, atol=1e-6)
    scaled = wrenches / np.repeat((LENGTH, 1.0), 3)
    np.testing.assert_allclose(scaled @ scaled.T, np.eye(len(wrenches)), atol=1e-12)
    motions = report.self_motions
    assert len(motions) == chain.n - report.rank
    np.testing.assert_allclose(J @ motions.T, 0.0, atol=1e-6)
    # A little aside the lost motion is there again.
    aside = jacobian(chain, np.array(q) + 0.1)
    assert np.abs(lost @ (aside * scale[:, None])).max() > 1e-3


@pytest.mark.parametrize("robot", DECOUPLED)
def test_the_determinant_is_the_product_of_its_factors(robot):
    chain = load_robot(robot)
    q = np.random.default_rng(4).uniform(-2.5, 2.5, (50, 6))
    products = [
        np.prod(list(singularity_report(chain, row, length=1).factors.values())) for row in q
    ]
    ratios = np.linalg.det(jacobian(chain, q)) / products
    np.testing.assert_allclose(ratios, ratios[0], rtol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    "robot",
    [
        "puma560",
        "panda",
        "scara",
        pytest.param("ur5e", marks=pytest.mark.long),
        pytest.param("gen3", marks=pytest.mark.long),
        pytest.param("general6r", marks=pytest.mark.long),
    ],
)
def test_regular_postures(robot):
    chain = load_robot(robot)
    q = np.random.default_rng(7).uniform(-1.5, 1.5, chain.n) + 0.2
    report = singularity_report(chain, q)
    assert not report.singular and report.kinds == () and report.rank == min(6, chain.n)
    assert report.length == characteristic_length(chain)
    assert report.lost_directions.shape == (0, 6)
    assert report.manipulability == pytest.approx(manipulability(chain, q), rel=1e-9)
    assert report.condition_number == pytest.approx(condition_number(chain, q), rel=1e-9)
    given = {"length": report.length}
    normalised = condition_number(chain, q, **given)
    assert report.normalised_condition_number == pytest.approx(normalised, rel=1e-9)


def test_without_a_name_the_joints_are_told():
    chain = chain_from_dh(
        [0.2, 0.3, 0.1, 0, 0, 0], [0, 0.1, 0, 0.4, 0.1, 0.2], [1, 0.7, 1, 1, 1, 0]
    )
    near = nearest_singular_posture(chain, np.full(6, 0.4), length=LENGTH)
    (kind,) = singularity_report(chain, near.q, length=LENGTH).kinds
    assert "depend on each other" in kind and "joint_" in kind


@pytest.mark.parametrize("robot", ["puma560", "ur5e", "stanford", "general6r", "xarm6"])
def test_no_singular_posture_is_nearer(robot):
    """The determinant keeps its sign up to the nearest one."""
    chain: SerialChain = load_robot(robot)
    rng = np.random.default_rng(11)
    for _ in range(4):
        q = rng.uniform(-1.5, 1.5, 6)
        near = nearest_singular_posture(chain, q, length=LENGTH)
        assert singularity_report(chain, near.q, length=LENGTH).singular
        unit = np.where(chain.types == 1, LENGTH, 1.0)
        assert near.distance == pytest.approx(np.linalg.norm((near.q - q) / unit))
        aside = rng.normal(size=(20_000, 6))
        aside *= 0.98 * near.distance / np.linalg.norm(aside, axis=1, keepdims=True)
        values = np.linalg.det(jacobian(chain, q + aside * unit))
        assert (np.sign(values) == np.sign(np.linalg.det(jacobian(chain, q)))).all()


@pytest.mark.parametrize("robot", ["panda", "iiwa14", "scara", "planar3r", "vx300"])
def test_nearest_of_arms_with_more_or_fewer_joints(robot):
    chain = load_robot(robot)
    q = np.random.default_rng(3).uniform(-1, 1, chain.n)
    near = nearest_singular_posture(chain, q, length=LENGTH)
    assert singularity_report(chain, near.q, length=LENGTH).singular
    assert 0.0 < near.distance < 3.0


def test_the_way_of_a_slide_to_a_singularity_counts_in_lengths():
    a, b = [0.2, 0.3, 0.1, 0.4, 0.2, 0.3], [0.1, 0.3, 0.4, 0.2, 0.1, 0.3]
    chain = chain_from_dh(a, b, [1.2, 0.8, 1.2, 0.6, 1.2, 1.0], types="RPRRRR")
    q = np.full(6, 0.3)
    near = nearest_singular_posture(chain, q, length=LENGTH)
    unit = np.where(chain.types == 1, LENGTH, 1.0)
    assert abs(near.q[1] - q[1]) > 1e-4
    assert near.distance == pytest.approx(np.linalg.norm((near.q - q) / unit))


def test_what_is_refused():
    chain = load_robot("puma560")
    with pytest.raises(WrongSizeError, match="q "):
        nearest_singular_posture(chain, np.zeros((2, 6)), length=LENGTH)
    with pytest.raises(NonFiniteError, match="joint 'shoulder' in row 1"):
        singularity_report(chain, [[0.0] * 6, [0.0, np.nan, 0, 0, 0, 0]], length=LENGTH)
    for ask in (singularity_report, nearest_singular_posture):
        with pytest.raises(WrongSizeError, match="q "):
            ask(chain, np.zeros((2, 5)), length=LENGTH)
        with pytest.raises(BadValueError, match="length .*a length from 1e-9 to 1e9 m"):
            ask(chain, np.zeros(6), length=-1.0)
        with pytest.raises(NonFiniteError, match="joint 'waist'"):
            ask(chain, [np.inf, 0, 0, 0, 0, 0], length=LENGTH)


@pytest.mark.parametrize("bad", [1e308, -1e6, np.nan, np.inf])
@pytest.mark.parametrize("search", [nearest_singular_posture, self_motion_curve])
def test_searches_refuse_postures_that_no_joint_takes(search, bad):
    chain = load_robot("panda")
    q = chain.home().copy()
    q[2] = bad
    with pytest.raises((BadValueError, NonFiniteError), match="q of joint 'panda_joint3'"):
        search(chain, q)


@pytest.mark.parametrize("robot", ["puma560", "ur5e", "scara", "planar3r", "iiwa14"])
def test_a_batch_says_of_each_posture_what_is_said_of_it_alone(robot):
    """Postures in rows were refused."""
    chain, rng = load_robot(robot), np.random.default_rng(4)
    q = rng.uniform(-2.0, 2.0, (3, 4, chain.n))
    q[0, :2] = next(posture for name, posture, _ in NAMED if name == robot)
    given = {"point": (0.1, 0.0, 0.2), "length": LENGTH}
    reports = singularity_report(chain, q, **given)
    assert reports.singular.shape == (3, 4) and reports.singular[0, :2].all()
    for k in np.ndindex(3, 4):
        alone, one = singularity_report(chain, q[k], **given), reports[k]
        assert one.kinds == alone.kinds == reports.kinds[k] and one.rank == reports.rank[k]
        assert one.factors == alone.factors and one.singular == alone.singular
        for field in ("lost_directions", "idle_wrenches", "self_motions", "singular_values"):
            np.testing.assert_array_equal(getattr(one, field), getattr(alone, field))
        for field in ("manipulability", "condition_number", "normalised_condition_number"):
            assert getattr(one, field) == getattr(alone, field) == getattr(reports, field)[k]
        assert np.isfinite(reports.idle_wrenches[k][:, 0]).sum() == 6 - one.rank
        J = jacobian(chain, q[k])
        assert one.rank == np.linalg.matrix_rank(J, tol=1e-7)
    none = singularity_report(chain, q[:0], **given)
    assert none.rank.shape == (0, 4) and none.lost_directions.shape == (0, 4, 6, 6)


def test_an_arm_with_more_joints_than_freedoms_is_judged_by_the_rank_it_has():
    # Planar, of four: no posture has rank 4, and what is out of the plane does not count.
    snake = chain_from_dh([1.0] * 4, [0.0] * 4, [0.0] * 4)
    report = singularity_report(snake, [0.3, 0.6, 0.9, 1.2])
    assert not report.singular and report.rank == 3
    assert report.length == characteristic_length(snake)
    expected = condition_number(snake, [0.3, 0.6, 0.9, 1.2])
    assert report.condition_number == pytest.approx(expected, rel=1e-14)
    expected = manipulability(snake, [0.3, 0.6, 0.9, 1.2])
    assert report.manipulability == pytest.approx(expected, rel=1e-14)
    straight = singularity_report(snake, [0.3, 0.0, 0.0, 1.2])
    assert straight.kinds == ("elbow",) and straight.rank == 2
    assert len(straight.lost_directions) == 1
    found = nearest_singular_posture(snake, [0.3, 0.1, 0.05, 1.2])
    assert found.distance == pytest.approx(np.hypot(0.1, 0.05), rel=1e-9)
