"""Homotopy paths of all solutions of seven quadrics in P^7, linear in the quadrics."""

import numpy as np

from robomech_ros._kernels.algebra.dense import factored, solve_factored
from robomech_ros._kernels.compiling.jit import inline, kernel
from robomech_ros._kernels.compiling.types import IOUT1, OUT1, i8
from robomech_ros._kernels.parallel.quadrics import (
    CIN2,
    COUT2,
    PRODUCTS,
    derivatives,
    products_of_order,
    values,
)

REGULAR, SINGULAR, FAILED = 0, 1, 2

# Order of the power series, and its largest last term.
_ORDER = 8
_TERM = 1e-4
# Largest part of the radius of convergence for a step.
_RADIUS = 0.6
# Largest number of corrections of a step, and largest last correction.
_CORRECTIONS = 4
_SETTLED = 1e-10
# Paths to a double root approach it as the root of 1 - t: this near to t = 1, step to the end only.
_LAST = 1e-8
_STEPS = 3000
_LEAST_STEP = 1e-13


@inline
def _scale(x):
    total = 0.0
    for i in range(8):
        total += x[i].real * x[i].real + x[i].imag * x[i].imag
    return np.sqrt(total)


@inline
def _mixed(K0, K1, t, K):
    for r in range(7):
        for m in range(PRODUCTS):
            K[r, m] = K0[r, m] + t * (K1[r, m] - K0[r, m])


@inline
def _correct(K, x, J, order, f):
    """Correct x by Newton steps; return whether they converge."""
    for _ in range(_CORRECTIONS):
        values(K, x, f)
        derivatives(K, x, J)
        f[7] = 0.0
        if not factored(J, order, 0.0):
            return False
        solve_factored(J, order, f)
        for i in range(8):
            x[i] -= f[i]
        size = _scale(f)
        if not size < 0.1:
            return False
        if size < _SETTLED:
            return True
    return False


@inline
def _series(K, D, J, order, series, products, b):
    """Write the terms of the power series from order 1; return the largest accurate step."""
    for k in range(1, _ORDER + 1):
        products_of_order(series, k - 1, 0, products)
        for r in range(7):
            b[r] = 0.0
            for m in range(PRODUCTS):
                b[r] -= D[r, m] * products[m]
        products_of_order(series, k, 1, products)
        for r in range(7):
            for m in range(PRODUCTS):
                b[r] -= K[r, m] * products[m]
        b[7] = 0.0
        solve_factored(J, order, b)
        for i in range(8):
            series[k, i] = b[i]
    last, before = _scale(series[_ORDER]), _scale(series[_ORDER - 1])
    if not last > 0.0:
        return 1.0
    return min((_TERM / last) ** (1.0 / _ORDER), _RADIUS * before / last)


@inline
def _predict(series, h, x):
    for i in range(8):
        value = series[_ORDER, i]
        for k in range(_ORDER - 1, -1, -1):
            value = value * h + series[k, i]
        x[i] = value


@inline
def _follow(K0, K1, K, D, x, space):
    """Track one path from t = 0; return its result and the last t."""
    J, order, series, products, b, trial = space
    t = 0.0
    for _ in range(_STEPS):
        size = 1.0 / _scale(x)
        for i in range(8):
            x[i] *= size
            series[0, i] = x[i]
        _mixed(K0, K1, t, K)
        derivatives(K, x, J)
        if not factored(J, order, 0.0):
            return FAILED, t
        h = _series(K, D, J, order, series, products, b)
        while True:
            if h >= 1.0 - t:
                h = 1.0 - t
            elif 1.0 - t <= 1.5 * _LAST:
                return SINGULAR, t
            elif 1.0 - t - h < _LAST:
                h = 1.0 - t - _LAST
            if h < _LEAST_STEP:
                return FAILED, t
            _predict(series, h, trial)
            following = 1.0 if h == 1.0 - t else t + h
            _mixed(K0, K1, following, K)
            if _correct(K, trial, J, order, b):
                break
            h *= 0.5
        t = following
        for i in range(8):
            x[i] = trial[i]
        if t == 1.0:
            return REGULAR, t
    return FAILED, t


@kernel(i8(CIN2, CIN2, COUT2, IOUT1, OUT1))
def track(K0, K1, X, ends, times):
    """Track solutions X (n, 8) in place from the quadrics K0 (7, 30) to K1 (7, 30).

    ``ends`` (n,) receives the result of each path, and ``times`` (n,) its last t.
    """
    K, D = np.empty((7, PRODUCTS), np.complex128), np.empty((7, PRODUCTS), np.complex128)
    for r in range(7):
        for m in range(PRODUCTS):
            D[r, m] = K1[r, m] - K0[r, m]
    space = (
        np.empty((8, 8), np.complex128),
        np.empty(8, np.int64),
        np.empty((_ORDER + 1, 8), np.complex128),
        np.empty(PRODUCTS, np.complex128),
        np.empty(8, np.complex128),
        np.empty(8, np.complex128),
    )
    count = 0
    for i in range(X.shape[0]):
        ends[i], times[i] = _follow(K0, K1, K, D, X[i], space)
        size = 1.0 / _scale(X[i])
        for j in range(8):
            X[i, j] *= size
        count += ends[i] == REGULAR
    return count
