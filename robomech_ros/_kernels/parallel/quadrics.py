"""Seven quadrics in the Study parameters x = (e, g) of a pose, as rows of 30 products.

The pose is the dual quaternion e + eps g, both parts scalar first: p = 2 g e* / (e . e).  With it
the condition |p + R b - a|^2 = s, times e . e, is linear in seventeen quadratic forms: e . e,
4 g . g, the entries of R, p, and q = R^T p, each times e . e.

References
----------
Husty, An algorithm for solving the direct kinematics of general Stewart-Gough platforms,
Mechanism and Machine Theory 31 (1996), pp. 365-380.
"""

import numpy as np
from numba import types

from robomech_ros._kernels.compiling.jit import inline

c16 = types.complex128
CIN2 = types.Array(c16, 2, "C", readonly=True)
COUT2 = types.Array(c16, 2, "C")

# Indices of the two parameters in each product: e e, e g, g g.
_PAIRS = (
    [(i, j) for i in range(4) for j in range(i, 4)]
    + [(i, 4 + j) for i in range(4) for j in range(4)]
    + [(4 + i, 4 + i) for i in range(4)]
)
PRODUCTS = len(_PAIRS)
_FIRST = np.array([pair[0] for pair in _PAIRS])
_SECOND = np.array([pair[1] for pair in _PAIRS])


def _row(terms):
    """Return the row (30,) of a quadratic form {(i, j): coefficient}."""
    row = np.zeros(PRODUCTS)
    for pair, coefficient in terms.items():
        row[_PAIRS.index(pair)] = coefficient
    return row


def _rotation_forms():
    """Yield the forms of the entries of R times e . e, row by row."""
    for i in range(3):
        for j in range(3):
            if i == j:
                yield {(k, k): 1.0 if k in (0, i + 1) else -1.0 for k in range(4)}
            else:
                k = 3 - i - j
                sign = -2.0 if (j - i) % 3 == 1 else 2.0
                yield {(min(i, j) + 1, max(i, j) + 1): 2.0, (0, k + 1): sign}


def _position_forms(turn):
    """Yield the forms of the components of 2 (e_0 g - g_0 e + turn e x g)."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        yield {
            (0, 5 + i): 2.0,
            (i + 1, 4): -2.0,
            (j + 1, 5 + k): 2.0 * turn,
            (k + 1, 5 + j): -2.0 * turn,
        }


# The seventeen forms (17, 30), and the condition e . g = 0 of the parameters of a pose.
FORMS = np.array(
    [
        _row({(k, k): 1.0 for k in range(4)}),
        _row({(4 + k, 4 + k): 4.0 for k in range(4)}),
        *map(_row, _rotation_forms()),
        *map(_row, _position_forms(1.0)),
        *map(_row, _position_forms(-1.0)),
    ]
)
STUDY = _row({(k, 4 + k): 1.0 for k in range(4)})


@inline
def values(K, x, f):
    """Write the values (7,) of the quadrics at x."""
    for r in range(7):
        f[r] = 0.0
    for m in range(PRODUCTS):
        product = x[_FIRST[m]] * x[_SECOND[m]]
        for r in range(7):
            f[r] += K[r, m] * product


@inline
def derivatives(K, x, J):
    """Write derivatives of the quadrics to rows 0 to 6 of J, and the conjugate of x to row 7."""
    J[:] = 0.0
    for m in range(PRODUCTS):
        i, j = _FIRST[m], _SECOND[m]
        for r in range(7):
            J[r, i] += K[r, m] * x[j]
            J[r, j] += K[r, m] * x[i]
    for i in range(8):
        J[7, i] = x[i].conjugate()


@inline
def products_of_order(series, k, low, out):
    """Write the coefficients of order k of all products, without factors of order below ``low``."""
    for m in range(PRODUCTS):
        i, j = _FIRST[m], _SECOND[m]
        total = 0.0j
        for n in range(low, k - low + 1):
            total += series[n, i] * series[k - n, j]
        out[m] = total
