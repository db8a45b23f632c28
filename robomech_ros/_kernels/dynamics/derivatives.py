"""Derivatives of inverse dynamics with respect to joint positions, rates and accelerations.

Source: Singh, Russo, Wensing, Efficient analytical derivatives of rigid-body dynamics using spatial
vector algebra, IEEE Robotics and Automation Letters 7, 2022, here about one reference point.
"""

import math

from robomech_ros._kernels.chain.serial import NOT_FINITE, OK
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, OUT3, OUT4, i8
from robomech_ros._kernels.dynamics.base_frame import (
    base_motion,
    dot,
    force_cross,
    inertia_times,
    joined,
    motion_cross,
    place_frames,
    placed_axis,
    placed_body,
    plus,
    six,
    wrench_about,
    write_six,
)
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS, SURROUNDINGS, TIP_WRENCH
from robomech_ros._kernels.dynamics.mass import (
    NO_BODY,
    NO_MOTION,
    NO_RATE,
    momentum_rate,
    rate_times,
    rates_joined,
    times_rate,
)
from robomech_ros._kernels.spatial.vectors import combined, cross


@lean
def _tip_terms(axes, wrench, tip, by_q):
    """Subtract the contribution of a tip wrench of constant direction to the derivatives."""
    count = by_q.shape[0]
    for i in range(count):
        S = six(axes[i])
        # The force is constant, but its point moves with the tip.
        mx, my, mz = cross(combined(S[3:], cross(S, tip), 1.0), wrench[3:])
        for j in range(count):
            by_q[j, i] -= axes[j, 0] * mx + axes[j, 1] * my + axes[j, 2] * mz
            if j > i:
                by_q[j, i] -= dot(motion_cross(S, axes[j]), wrench)


@lean
def derivatives_body(model, q, qd, qdd, around, by_q, by_qd, M):
    """Write the derivatives (n, n) of the torques; for accelerations this is the mass matrix M."""
    frames = scratch(MOST_JOINTS, 12)
    axes = scratch(MOST_JOINTS, 6)
    rates = scratch(MOST_JOINTS, 6)
    second_rates = scratch(MOST_JOINTS, 6)
    velocities = scratch(MOST_JOINTS, 6)
    accelerations = scratch(MOST_JOINTS, 6)
    status, point, tip = place_frames(model, q, frames)
    velocity, acceleration = base_motion(around, point)
    count = model.shape[0] - 1
    for i in range(count):
        S = placed_axis(model, frames, i, point)
        # A joint does not change its own axis, so the rates from the link before it are valid.
        first = motion_cross(velocity, S)
        second = plus(motion_cross(acceleration, S), motion_cross(velocity, first), 1.0)
        velocity = plus(velocity, S, qd[i])
        acceleration = plus(plus(acceleration, S, qdd[i]), first, qd[i])
        write_six(axes[i], S)
        write_six(rates[i], first)
        write_six(second_rates[i], second)
        write_six(velocities[i], velocity)
        write_six(accelerations[i], acceleration)
    whole, B, force = NO_BODY, NO_RATE, NO_MOTION
    for i in range(count - 1, -1, -1):
        body = placed_body(model, frames, i, point)
        velocity = six(velocities[i])
        whole = joined(whole, body)
        B = rates_joined(B, momentum_rate(body, velocity))
        force = plus(force, inertia_times(body, accelerations[i]), 1.0)
        force = plus(force, force_cross(velocity, inertia_times(body, velocity)), 1.0)
        S, first = six(axes[i]), six(rates[i])
        inert = inertia_times(whole, S)
        left = times_rate(S, B)
        by_value = plus(inertia_times(whole, second_rates[i]), rate_times(B, first), 2.0)
        by_value = plus(by_value, force_cross(S, force), 1.0)
        by_rate = plus(inertia_times(whole, first), rate_times(B, S), 1.0)
        for j in range(i + 1):
            R, turned = axes[j], rates[j]
            M[i, j] = dot(R, inert)
            M[j, i] = M[i, j]
            by_q[j, i] = dot(R, by_value)
            by_qd[j, i] = 2.0 * dot(R, by_rate)
            by_q[i, j] = dot(inert, second_rates[j]) + 2.0 * (
                left[0] * turned[0] + left[1] * turned[1] + left[2] * turned[2]
            )
            by_qd[i, j] = 2.0 * (
                dot(inert, turned) + left[0] * R[0] + left[1] * R[1] + left[2] * R[2]
            )
        M[i, i] += model[i, 23]
    wrench = wrench_about(around, tip)
    for j in range(TIP_WRENCH, SURROUNDINGS):
        if around[j] != 0.0:
            _tip_terms(axes, wrench, tip, by_q)
            break
    for i in range(count):
        for j in range(count):
            if not (math.isfinite(by_q[i, j]) and math.isfinite(by_qd[i, j])):
                status = NOT_FINITE
    return status


@kernel(i8(IN2, IN1, IN1, IN1, IN2, OUT3))
def inverse_derivatives_one(model, q, qd, qdd, around, out):
    """Differentiate the torques of one state (n,), with the one row of ``around``.

    The three matrices of :func:`derivatives_body` are written to out (3, n, n).
    """
    return derivatives_body(model, q, qd, qdd, around[0], out[0], out[1], out[2])


@kernel(i8(IN2, IN2, IN2, IN2, IN2, OUT4))
def inverse_derivatives(model, q, qd, qdd, around, out):
    """Differentiate the torques of states (m, n); write three arrays (m, n, n) to out."""
    status = OK
    last = around.shape[0] - 1
    for k in range(q.shape[0]):
        row = around[min(k, last)]
        status |= derivatives_body(model, q[k], qd[k], qdd[k], row, out[0, k], out[1, k], out[2, k])
    return status
