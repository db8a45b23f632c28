"""The equations of doc/inverse_kinematics.md, on random arms and postures."""

import numpy as np
import pytest

from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.equations.closure import circle, closure_equations
from robomech_ros.robots import chain_from_dh


def decoupled(seed):
    """Lengths, offsets and twists of an arm with a spherical wrist, a posture, and its matrices."""
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(0.1, 1.0, (2, 6))
    a[3:5], b[4] = 0.0, 0.0
    alpha, q = rng.uniform(0.2, 1.4, 6), rng.uniform(-3.0, 3.0, 6)
    matrices = [
        forward_kinematics(chain_from_dh([a[i]], [b[i]], [alpha[i]]), [q[i]]) for i in range(6)
    ]
    return a, b, alpha, q, matrices


def centre_of(a, b, alpha, matrices):
    T = np.linalg.multi_dot(matrices)
    tail = [a[5], b[5] * np.sin(alpha[5]), b[5] * np.cos(alpha[5])]
    return T[:3, 3] - T[:3, :3] @ tail


@pytest.mark.parametrize("seed", range(5))
def test_wrist_centre_and_the_two_equations_free_of_joint_2(seed):
    a, b, alpha, q, matrices = decoupled(seed)
    x, y, z = centre_of(a, b, alpha, matrices)
    np.testing.assert_allclose((x, y, z), np.linalg.multi_dot(matrices[:4])[:3, 3], atol=1e-12)
    (a1, a2, a3), (b1, b2, b3, b4) = a[:3], b[:4]
    (l1, l2, l3), (m1, m2, m3) = np.cos(alpha[:3]), np.sin(alpha[:3])
    A, B = 2 * a1 * x, 2 * a1 * y
    C = 2 * a2 * a3 - 2 * b2 * b4 * m2 * m3
    D = 2 * a3 * b2 * m2 + 2 * a2 * b4 * m3
    E = a2**2 + a3**2 + b2**2 + b3**2 + b4**2 - a1**2 - x**2 - y**2 - (z - b1) ** 2
    E += 2 * b2 * b3 * l2 + 2 * b2 * b4 * l2 * l3 + 2 * b3 * b4 * l3
    F, G, H, S = y * m1, -x * m1, -b4 * m2 * m3, a3 * m2
    J = b2 + b3 * l2 + b4 * l2 * l3 - (z - b1) * l1
    c1, s1, c3, s3 = np.cos(q[0]), np.sin(q[0]), np.cos(q[2]), np.sin(q[2])
    assert A * c1 + B * s1 + C * c3 + D * s3 + E == pytest.approx(0.0, abs=1e-12)
    assert F * c1 + G * s1 + H * c3 + S * s3 + J == pytest.approx(0.0, abs=1e-12)
    assert pytest.approx(-2 * a1 * m1 * (x**2 + y**2)) == A * G - F * B
    u, v = 4 * a1**2, m1**2
    K, L, M = u * H * H + v * C * C, u * S * S + v * D * D, 2 * (u * H * S + v * C * D)
    N, P = 2 * (u * H * J + v * C * E), 2 * (u * S * J + v * D * E)
    Q = u * J * J + v * E * E - u * v * (x**2 + y**2)
    quartic = [K - N + Q, 2 * (P - M), 2 * (Q + 2 * L - K), 2 * (M + P), K + N + Q]
    assert abs(np.polyval(quartic, np.tan(q[2] / 2))) < 1e-10 * (1 + np.tan(q[2] / 2) ** 4)


@pytest.mark.parametrize("seed", range(5))
def test_the_same_conditions_as_the_code_has_them(seed):
    a, b, alpha, q, matrices = decoupled(seed)
    centre = centre_of(a, b, alpha, matrices)

    def link(i):
        return forward_kinematics(chain_from_dh([a[i]], [b[i]], [alpha[i]]), [0.0])

    def turn(angle):
        return forward_kinematics(chain_from_dh([0.0], [0.0], [0.0]), [angle])

    R, t = link(0)[:3, :3], link(0)[:3, 3]
    p = (link(1) @ turn(q[2]) @ link(2) @ np.array([0.0, 0.0, b[3], 1.0]))[:3]
    r = turn(q[1])[:3, :3] @ p
    n, s = R[2], R.T @ t
    assert n @ r == pytest.approx(centre[2] - t[2])
    assert s @ r == pytest.approx(0.5 * (centre @ centre - t @ t - p @ p))
    np.testing.assert_allclose((turn(q[0])[:3, :3] @ (R @ r + t)), centre, atol=1e-12)
    g = n[:2] / np.hypot(*n[:2])
    eta, h = s[1] * g[0] - s[0] * g[1], np.array([-g[1], g[0]]) @ r[:2]
    along = (centre[2] - t[2] - n[2] * p[2]) / np.hypot(*n[:2])
    E = 0.5 * (centre @ centre - t @ t - p @ p) - s[2] * p[2] - s[:2] @ g * along
    np.testing.assert_allclose(E, eta * h, atol=1e-12)
    room = p[0] ** 2 + p[1] ** 2 - along**2
    np.testing.assert_allclose(E**2, eta**2 * room, atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_the_wrist(seed):
    _, _, alpha, q, matrices = decoupled(seed)
    wrist = np.linalg.multi_dot(matrices[3:])[:3, :3]
    l4, l5, l6 = np.cos(alpha[3:])
    m4, m5, m6 = np.sin(alpha[3:])
    xi, eta, zeta = wrist @ [0.0, m6, l6]
    tau = np.tan(q[3] / 2)
    first, last = l5 - eta * m4 - zeta * l4, l5 + eta * m4 - zeta * l4
    assert first * tau**2 - 2 * xi * m4 * tau + last == pytest.approx(
        0.0, abs=1e-11 + 1e-11 * tau**2
    )
    assert np.cos(q[4]) == pytest.approx((l4 * l5 - zeta) / (m4 * m5))
    psi, low = np.arccos(zeta), abs(alpha[3] - alpha[4])
    high = np.pi - abs(np.pi - alpha[3] - alpha[4])
    product = np.prod(np.sin(0.5 * np.array([psi - low, high - psi, psi + low, high + psi])))
    assert abs(m4 * m5 * np.sin(q[4])) == pytest.approx(2 * np.sqrt(product))
    across = np.array([m5 * np.sin(q[4]), -l4 * m5 * np.cos(q[4]) - m4 * l5])
    c, s = np.cos(q[3]), np.sin(q[3])
    np.testing.assert_allclose([[c, -s], [s, c]] @ across, [xi, eta], atol=1e-12)


def test_a_general_arm_has_six_equations_that_its_postures_obey():
    rng = np.random.default_rng(3)
    arm = chain_from_dh(*rng.uniform(0.1, 1.0, (2, 6)), rng.uniform(0.3, 1.4, 6))
    q = rng.uniform(-3.0, 3.0, 6)
    T = forward_kinematics(arm, q)
    equations = closure_equations(arm, T)
    for posture in inverse_kinematics(arm, T, respect_limits=False).q:
        value = np.einsum("eijk,i,j,k", equations.free, *(circle(x) for x in posture[2:5]))
        np.testing.assert_allclose(value, 0.0, atol=1e-8)
