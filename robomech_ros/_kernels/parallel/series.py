"""Power series of poses along paths of squared leg lengths, for a batch of paths.

In the frame of the platform, with x = (tau, w), g_0 = -w . tau and base points a, the condition of
a leg is

    d . tau + (b x d) . w + tau . tau + (a + b) . (tau x w) + (a . b) w . w - (a . w)(b . w)
        + g_0^2 - g_0 d . w = (s - d . d) / 4 (1 + w . w).
"""

from robomech_ros._kernels.compiling.jit import fused
from robomech_ros._kernels.parallel.simd_batch import LANES, solve

ORDER = 8
# Parts of a leg's quadratic form: tau . tau, tau x w (3), products of w (6), g_0^2, g_0 w (3).
PARTS = 14


@fused
def coefficients(ar, ai, B, Mr, Mi):
    """Write the coefficients of the parts for each leg; those of tau . tau and g_0^2 are one."""
    for k in range(6):
        u, v, w = B[k, 0], B[k, 1], B[k, 2]
        for n in range(LANES):
            x, y, z = ar[k, 0, n], ar[k, 1, n], ar[k, 2, n]
            p, q, r = ai[k, 0, n], ai[k, 1, n], ai[k, 2, n]
            Mr[k, 0, n], Mr[k, 1, n], Mr[k, 2, n] = x + u, y + v, z + w
            Mi[k, 0, n], Mi[k, 1, n], Mi[k, 2, n] = p, q, r
            Mr[k, 3, n], Mi[k, 3, n] = y * v + z * w, q * v + r * w
            Mr[k, 4, n], Mi[k, 4, n] = x * u + z * w, p * u + r * w
            Mr[k, 5, n], Mi[k, 5, n] = x * u + y * v, p * u + q * v
            Mr[k, 6, n], Mi[k, 6, n] = -(x * v + y * u), -(p * v + q * u)
            Mr[k, 7, n], Mi[k, 7, n] = -(y * w + z * v), -(q * w + r * v)
            Mr[k, 8, n], Mi[k, 8, n] = -(z * u + x * w), -(r * u + p * w)
            Mr[k, 9, n], Mr[k, 10, n], Mr[k, 11, n] = x - u, y - v, z - w
            Mi[k, 9, n], Mi[k, 10, n], Mi[k, 11, n] = p, q, r


@fused
def _parts(Sr, Si, k, Pr, Pi):
    """Write the parts (14, LANES) of order k, and g_0 to row 6 of the series."""
    for i in range(PARTS):
        for n in range(LANES):
            Pr[i, n], Pi[i, n] = 0.0, 0.0
    for n in range(LANES):
        Sr[k, 6, n], Si[k, 6, n] = 0.0, 0.0
    for j in range(1, k):
        m = k - j
        for n in range(LANES):
            a, b, c = Sr[j, 0, n], Sr[j, 1, n], Sr[j, 2, n]
            d, e, f = Si[j, 0, n], Si[j, 1, n], Si[j, 2, n]
            u, v, w = Sr[m, 3, n], Sr[m, 4, n], Sr[m, 5, n]
            x, y, z = Si[m, 3, n], Si[m, 4, n], Si[m, 5, n]
            Sr[k, 6, n] -= (a * u - d * x) + (b * v - e * y) + (c * w - f * z)
            Si[k, 6, n] -= (a * x + d * u) + (b * y + e * v) + (c * z + f * w)
            Pr[1, n] += (b * w - e * z) - (c * v - f * y)
            Pi[1, n] += (b * z + e * w) - (c * y + f * v)
            Pr[2, n] += (c * u - f * x) - (a * w - d * z)
            Pi[2, n] += (c * x + f * u) - (a * z + d * w)
            Pr[3, n] += (a * v - d * y) - (b * u - e * x)
            Pi[3, n] += (a * y + d * v) - (b * x + e * u)
        for n in range(LANES):
            a, b, c = Sr[j, 0, n], Sr[j, 1, n], Sr[j, 2, n]
            d, e, f = Si[j, 0, n], Si[j, 1, n], Si[j, 2, n]
            u, v, w = Sr[m, 0, n], Sr[m, 1, n], Sr[m, 2, n]
            x, y, z = Si[m, 0, n], Si[m, 1, n], Si[m, 2, n]
            Pr[0, n] += (a * u - d * x) + (b * v - e * y) + (c * w - f * z)
            Pi[0, n] += (a * x + d * u) + (b * y + e * v) + (c * z + f * w)
        for n in range(LANES):
            a, b, c = Sr[j, 3, n], Sr[j, 4, n], Sr[j, 5, n]
            d, e, f = Si[j, 3, n], Si[j, 4, n], Si[j, 5, n]
            u, v, w = Sr[m, 3, n], Sr[m, 4, n], Sr[m, 5, n]
            x, y, z = Si[m, 3, n], Si[m, 4, n], Si[m, 5, n]
            Pr[4, n] += a * u - d * x
            Pi[4, n] += a * x + d * u
            Pr[5, n] += b * v - e * y
            Pi[5, n] += b * y + e * v
            Pr[6, n] += c * w - f * z
            Pi[6, n] += c * z + f * w
            Pr[7, n] += a * v - d * y
            Pi[7, n] += a * y + d * v
            Pr[8, n] += b * w - e * z
            Pi[8, n] += b * z + e * w
            Pr[9, n] += c * u - f * x
            Pi[9, n] += c * x + f * u
            g, h = Sr[j, 6, n], Si[j, 6, n]
            p, q = Sr[m, 6, n], Si[m, 6, n]
            Pr[10, n] += g * p - h * q
            Pi[10, n] += g * q + h * p
            Pr[11, n] += g * u - h * x
            Pi[11, n] += g * x + h * u
            Pr[12, n] += g * v - h * y
            Pi[12, n] += g * y + h * v
            Pr[13, n] += g * w - h * z
            Pi[13, n] += g * z + h * w


@fused
def _leg(Mr, Mi, i, Pr, Pi, g, h, xr, xi):
    """Write the right side of leg i; the factor of the rate is 1 + w . w of the order before."""
    for n in range(LANES):
        u, v = Pr[PARTS + 6, n], Pi[PARTS + 6, n]
        a = g * u - h * v - Pr[0, n] - Pr[10, n]
        b = g * v + h * u - Pi[0, n] - Pi[10, n]
        for j in range(12):
            m = j + 1 if j < 9 else j + 2
            x, y, u, v = Mr[i, j, n], Mi[i, j, n], Pr[m, n], Pi[m, n]
            a -= x * u - y * v
            b -= x * v + y * u
        xr[i, n], xi[i, n] = a, b


@fused
def series(Jr, Ji, Mr, Mi, rate_r, rate_i, Sr, Si, Pr, Pi):
    """Write the series (9, 7, LANES) of tau, w and g_0 for rates (6,) of (s - d . d) / 4."""
    xr, xi = Pr[PARTS : PARTS + 6], Pi[PARTS : PARTS + 6]
    for n in range(LANES):
        Pr[PARTS + 6, n], Pi[PARTS + 6, n] = 1.0, 0.0
    for k in range(1, ORDER + 1):
        _parts(Sr, Si, k, Pr, Pi)
        for i in range(6):
            _leg(Mr, Mi, i, Pr, Pi, rate_r[i], rate_i[i], xr, xi)
        for n in range(LANES):
            Pr[PARTS + 6, n] = Pr[4, n] + Pr[5, n] + Pr[6, n]
            Pi[PARTS + 6, n] = Pi[4, n] + Pi[5, n] + Pi[6, n]
        solve(Jr, Ji, xr, xi)
        for i in range(6):
            for n in range(LANES):
                Sr[k, i, n], Si[k, i, n] = xr[i, n], xi[i, n]
