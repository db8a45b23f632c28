"""Every representation to every other and back, most of all near the identity and half turns."""

import numpy as np
import pinocchio
import pytest
from scipy.spatial.transform import Rotation, Slerp

from robomech_ros import spatial
from robomech_ros.errors import BadQuaternionError, BadValueError, WrongSizeError

COUNT, EXACT = 100_000, 1000
NAMED = [name for name in spatial.REPRESENTATIONS if name not in spatial.SEQUENCES]
# They have no numbers for a half turn, or none that tell its axis.
NOT_AT_PI = ("rodrigues-vector", "linear-invariants")
# A few times 1e-15: what the entries of a matrix, of 1e-16 each, allow.
ROUNDING = 4e-15


def hard_rotations(count):
    """Angles of 0, of 1e-12 to 1e-3, as near to pi, pi itself, and any: axes and angles."""
    rng = np.random.default_rng(2)
    axes = rng.normal(size=(count, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    small = 10.0 ** rng.uniform(-12.0, -3.0, count)
    kind = rng.integers(0, 5, count)
    angles = np.choose(
        kind, [small, small, np.pi - small, np.pi - small, rng.uniform(0, np.pi, count)]
    )
    angles[:EXACT] = np.pi
    angles[EXACT : 2 * EXACT] = 0.0
    return axes, angles


AXES, ANGLES = hard_rotations(COUNT)
QUATERNIONS = spatial.quaternion_from_axis_angle(AXES, ANGLES)


def difference(p, q):
    """Angles between rotations given as quaternions, small ones with all digits."""
    sign = np.where(np.sum(p * q, axis=-1, keepdims=True) < 0.0, -1.0, 1.0)
    return 2.0 * np.linalg.norm(sign * p - q, axis=-1)


def round_trip(source, target, quaternions):
    """Largest angle between rotations and what they are after the way there and back."""
    first = EXACT if {source, target} & set(NOT_AT_PI) else 0
    given = spatial.convert_rotation(quaternions[first:], "quaternion", source)
    there = spatial.convert_rotation(given, source, target)
    again = spatial.convert_rotation(there, target, source)
    pair = (spatial.convert_rotation(one, source, "quaternion") for one in (given, again))
    return difference(*pair).max()


@pytest.mark.parametrize("source", NAMED)
def test_round_trips_of_every_pair_lose_nothing_at_any_angle(source):
    for target in NAMED:
        assert round_trip(source, target, QUATERNIONS) < ROUNDING, target


@pytest.mark.parametrize("every", [20, pytest.param(1, marks=pytest.mark.long)])
@pytest.mark.parametrize("sequence", spatial.SEQUENCES)
def test_round_trips_of_every_pair_with_euler_angles_lose_nothing(sequence, every):
    before = spatial.SEQUENCES[: spatial.SEQUENCES.index(sequence)]
    given = QUATERNIONS[::every]
    below = given[given[:, 3] > 1e-13]
    for other in (one for one in spatial.REPRESENTATIONS if one not in before):
        few = below if other in NOT_AT_PI else given
        first = spatial.convert_rotation(few, "quaternion", sequence)
        there = spatial.convert_rotation(first, sequence, other)
        again = spatial.convert_rotation(there, other, sequence)
        ends = (spatial.convert_rotation(one, sequence, "quaternion") for one in (first, again))
        assert difference(*ends).max() < ROUNDING, other


@pytest.mark.parametrize("sequence", spatial.SEQUENCES)
def test_round_trips_by_euler_angles_lose_nothing(sequence):
    for other in (*NAMED, "ZYX", "zxz"):
        few = QUATERNIONS[::37] if other in NAMED else QUATERNIONS[::101]
        first = slice(EXACT, None) if other in NOT_AT_PI else slice(None)
        for pair in ((sequence, other), (other, sequence)):
            few = few[few[:, 3] > 1e-13] if first.start else few
            given = spatial.convert_rotation(few, "quaternion", pair[0])
            there = spatial.convert_rotation(given, *pair)
            again = spatial.convert_rotation(there, *pair[::-1])
            ends = (spatial.convert_rotation(one, pair[0], "quaternion") for one in (given, again))
            assert difference(*ends).max() < ROUNDING, pair


def test_rotation_vectors_keep_their_relative_precision():
    small = (ANGLES > 0.0) & (ANGLES < 1.0)
    vectors = AXES[small] * ANGLES[small, None]
    for way in ("matrix", "quaternion", "linear-invariants", "rodrigues-vector", "XYZ"):
        there = spatial.convert_rotation(vectors, "rotation-vector", way)
        again = spatial.convert_rotation(there, way, "rotation-vector")
        off = np.linalg.norm(again - vectors, axis=-1) / ANGLES[small]
        assert off.max() < 3e-15, way


@pytest.mark.parametrize("sequence", spatial.SEQUENCES)
def test_euler_angles_are_those_of_scipy(sequence):
    rotations = Rotation.random(300, rng=np.random.default_rng(3))
    angles = rotations.as_euler(sequence)
    found = spatial.euler_angles_from_matrix(rotations.as_matrix(), sequence)
    np.testing.assert_allclose(found, angles, atol=2e-13)
    again = spatial.matrix_from_euler_angles(angles, sequence)
    np.testing.assert_allclose(again, rotations.as_matrix(), atol=3e-15)
    quaternions = spatial.quaternion_from_euler_angles(angles, sequence)
    np.testing.assert_allclose(quaternions, rotations.as_quat(canonical=True), atol=3e-15)
    back = spatial.euler_angles_from_quaternion(quaternions, sequence)
    np.testing.assert_allclose(back, angles, atol=2e-13)


@pytest.mark.parametrize("sequence", spatial.SEQUENCES)
def test_where_outer_axes_are_parallel_the_third_angle_is_zero(sequence):
    proper = sequence[0] == sequence[2]
    for middle in (0.0, np.pi) if proper else (0.5 * np.pi, -0.5 * np.pi):
        Q = spatial.matrix_from_euler_angles([0.7, middle, -0.4], sequence)
        found = spatial.euler_angles_from_matrix(Q, sequence)
        assert found[2] == 0.0
        np.testing.assert_allclose(spatial.matrix_from_euler_angles(found, sequence), Q, atol=1e-15)


def test_pinocchio_converts_the_same():
    for e, angle in zip(AXES[::997], ANGLES[::997], strict=True):
        vector = e * angle
        Q = spatial.matrix_from_rotation_vector(vector)
        np.testing.assert_allclose(Q, pinocchio.exp3(vector), atol=2e-15)
        theirs = pinocchio.Quaternion(Q).coeffs()
        ours = spatial.quaternion_from_matrix(Q)
        assert difference(theirs, ours) < ROUNDING
        rpy = pinocchio.rpy.matrixToRpy(Q)
        np.testing.assert_allclose(pinocchio.rpy.rpyToMatrix(rpy), Q, atol=1e-14)
        again = spatial.matrix_from_euler_angles(rpy, "xyz")
        np.testing.assert_allclose(again, Q, atol=1e-14)


def scipy_numbers(rotations):
    """Every representation of rotations as scipy has it."""
    vector = rotations.as_rotvec()
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    axis = vector / angle
    quaternion = rotations.as_quat(canonical=True)
    # Rodrigues vectors are r / r0; scipy's modified ones are e tan(phi / 4).
    modified = rotations.as_mrp()
    rodrigues = 2.0 * modified / (1.0 - np.sum(modified**2, axis=-1, keepdims=True))
    numbers = {
        "matrix": rotations.as_matrix(),
        "quaternion": quaternion,
        "axis-angle": np.concatenate((axis, angle), axis=-1),
        "rotation-vector": vector,
        "rodrigues-vector": rodrigues,
        "linear-invariants": np.concatenate((axis * np.sin(angle), np.cos(angle)), axis=-1),
    }
    return numbers | {name: rotations.as_euler(name) for name in spatial.SEQUENCES}


def pinocchio_numbers(Q):
    """Representations of a rotation as Pinocchio has them."""
    quaternion = pinocchio.Quaternion(Q).coeffs()
    turn = pinocchio.AngleAxis(Q)
    vector = pinocchio.log3(Q)
    sine, cosine = np.sin(turn.angle), np.cos(turn.angle)
    return {
        "matrix": pinocchio.exp3(vector),
        "quaternion": quaternion * np.where(quaternion[3] < 0.0, -1.0, 1.0),
        "axis-angle": np.append(turn.axis, turn.angle),
        "rotation-vector": vector,
        "rodrigues-vector": turn.axis * np.tan(0.5 * turn.angle),
        "linear-invariants": np.append(turn.axis * sine, cosine),
        "xyz": pinocchio.rpy.matrixToRpy(Q),
    }


@pytest.mark.parametrize("source", spatial.REPRESENTATIONS)
def test_every_conversion_is_that_of_scipy_and_of_pinocchio(source):
    rotations = Rotation.random(60, rng=np.random.default_rng(9))
    theirs = scipy_numbers(rotations)
    for target, expected in theirs.items():
        found = spatial.convert_rotation(theirs[source], source, target)
        scale = 1.0 + np.abs(expected).max() ** 2
        np.testing.assert_allclose(found, expected, atol=2e-13 * scale, err_msg=target)
    for k, Q in enumerate(theirs["matrix"]):
        for target, expected in pinocchio_numbers(Q).items():
            found = spatial.convert_rotation(theirs[source][k], source, target)
            scale = 1.0 + np.abs(expected).max() ** 2
            np.testing.assert_allclose(found, expected, atol=1e-12 * scale, err_msg=target)


def test_roll_pitch_yaw_are_the_sequence_xyz_of_fixed_axes():
    Q = Rotation.random(200, rng=np.random.default_rng(4)).as_matrix()
    np.testing.assert_allclose(
        spatial.euler_angles_from_matrix(Q, "xyz"),
        spatial.roll_pitch_yaw_from_matrix(Q),
        atol=1e-13,
    )


def test_linear_invariants_of_the_book():
    Q = np.array([[-1, -2, 2], [-2, 2, 1], [-2, -1, -2]]) / 3.0
    vect, trace = spatial.linear_invariants(Q)
    assert trace == pytest.approx(-1.0 / 3.0, abs=1e-15)
    np.testing.assert_allclose(spatial.matrix_from_linear_invariants(vect, trace), Q, atol=1e-15)
    rng = np.random.default_rng(5)
    a, b = rng.normal(size=(2, 50, 3))
    vect, trace = spatial.linear_invariants(a[:, :, None] * b[:, None, :])
    np.testing.assert_allclose(vect, -0.5 * np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose(trace, np.sum(a * b, axis=-1), atol=1e-15)
    A = rng.normal(size=(50, 3, 3))
    vect, trace = spatial.linear_invariants(spatial.cross_product_matrix(a) @ A)
    half = 0.5 * (np.trace(A, axis1=1, axis2=2)[:, None, None] * np.eye(3) - A)
    np.testing.assert_allclose(vect, (half @ a[..., None])[..., 0], atol=1e-14)


@pytest.mark.parametrize("name", [*NAMED, "ZXZ", "yxz"])
def test_composition_is_that_of_matrices(name):
    p, q = (Rotation.random(100, rng=np.random.default_rng(seed)).as_matrix() for seed in (6, 7))
    one, two = (spatial.convert_rotation(Q, "matrix", name) for Q in (p, q))
    product = spatial.convert_rotation(spatial.compose_rotations(one, two, name), name, "matrix")
    np.testing.assert_allclose(product, p @ q, atol=1e-14)
    for many, single in ((one, two[0]), (one[0], two)):
        product = spatial.compose_rotations(many, single, name)
        expected = spatial.convert_rotation(many, name, "matrix") @ spatial.convert_rotation(
            single, name, "matrix"
        )
        np.testing.assert_allclose(
            spatial.convert_rotation(product, name, "matrix"), expected, atol=1e-14
        )


def test_slerp_is_that_of_scipy_and_takes_the_short_way():
    rotations = Rotation.random(2, rng=np.random.default_rng(8))
    fractions = np.linspace(0.0, 1.0, 41)
    q = rotations.as_quat()
    for start, goal in ((q[0], q[1]), (-q[0], q[1])):
        found = spatial.slerp(start, goal, fractions)
        expected = Slerp([0, 1], rotations)(fractions).as_quat(canonical=True)
        np.testing.assert_allclose(found, expected, atol=2e-15)
    # All digits for neighbours.
    near = spatial.quaternion_from_rotation_vector([1e-9, 0.0, 0.0])
    half = spatial.slerp([0, 0, 0, 1], near, 0.5)
    assert spatial.rotation_vector_from_quaternion(half)[0] == pytest.approx(5e-10, rel=1e-14)
    assert spatial.slerp(q[0], q[0], 0.3).tobytes() == spatial.slerp(q[0], q[0], 0.0).tobytes()
    pairs = spatial.slerp(q, q[::-1], [[0.0], [1.0]])
    assert pairs.shape == (2, 2, 4)
    np.testing.assert_allclose(pairs[1], spatial.slerp(q[::-1], q, 0.0), atol=1e-15)


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (
            lambda: spatial.convert_rotation(np.eye(3), "matrix", "euler"),
            BadValueError,
            "target is",
        ),
        (lambda: spatial.euler_angles_from_matrix(np.eye(3), "XYY"), BadValueError, "sequence is"),
        (
            lambda: spatial.rodrigues_vector_from_matrix(np.diag([1.0, -1.0, -1.0])),
            BadValueError,
            "less than a half turn",
        ),
        (
            lambda: spatial.matrix_from_linear_invariants([0, 0, 0], -1.0),
            BadValueError,
            "less than a half turn",
        ),
        (lambda: spatial.matrix_from_linear_invariants([0, 0, 0.9], 2.0), BadValueError, "norm 1"),
        (lambda: spatial.slerp([0, 0, 0, 2], [0, 0, 0, 1], 0.5), BadQuaternionError, "norm is 2"),
        (
            lambda: spatial.matrix_from_axis_angle(np.ones((2, 3)), np.ones(5)),
            WrongSizeError,
            "fit together",
        ),
        (
            lambda: spatial.convert_rotation(2.0 * np.eye(3)[None], "matrix", "quaternion"),
            BadValueError,
            "matrix in row 0",
        ),
    ],
)
def test_what_is_no_rotation_or_has_no_numbers_is_refused(call, error, text):
    with pytest.raises(error, match=text):
        call()
