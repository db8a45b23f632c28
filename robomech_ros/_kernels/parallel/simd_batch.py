"""Operations on batches of eight poses, which are along the last axis of each array.

Real and imaginary parts of complex numbers are in separate arrays.  A loop over the poses becomes
a few SIMD instructions if it is innermost or contains only short loops of constant length, which
are unrolled; then sums stay in registers.
"""

from robomech_ros._kernels.compiling.jit import fused

LANES = 8


@fused
def _turn(pr, pi, mr, mi):
    """Write R row by row and q = R^T p (12, LANES) of the poses (8, LANES)."""
    for n in range(LANES):
        a, b, c, d = pr[0, n], pr[1, n], pr[2, n], pr[3, n]
        p, q, r, s = pi[0, n], pi[1, n], pi[2, n], pi[3, n]
        # Squares and products of the quaternion (a + ip, b + iq, c + ir, d + is).
        aa, ax = a * a - p * p, 2.0 * a * p
        bb, bx = b * b - q * q, 2.0 * b * q
        cc, cx = c * c - r * r, 2.0 * c * r
        dd, dx = d * d - s * s, 2.0 * d * s
        ab, ay = a * b - p * q, a * q + p * b
        ac, az = a * c - p * r, a * r + p * c
        ad, aw = a * d - p * s, a * s + p * d
        bc, by = b * c - q * r, b * r + q * c
        bd, bz = b * d - q * s, b * s + q * d
        cd, cy = c * d - r * s, c * s + r * d
        x, y = aa + bb + cc + dd, ax + bx + cx + dx
        size = 1.0 / (x * x + y * y)
        x, y = x * size, -y * size
        u, v = aa + bb - cc - dd, ax + bx - cx - dx
        mr[0, n], mi[0, n] = u * x - v * y, u * y + v * x
        u, v = 2.0 * (bc - ad), 2.0 * (by - aw)
        mr[1, n], mi[1, n] = u * x - v * y, u * y + v * x
        u, v = 2.0 * (bd + ac), 2.0 * (bz + az)
        mr[2, n], mi[2, n] = u * x - v * y, u * y + v * x
        u, v = 2.0 * (bc + ad), 2.0 * (by + aw)
        mr[3, n], mi[3, n] = u * x - v * y, u * y + v * x
        u, v = aa - bb + cc - dd, ax - bx + cx - dx
        mr[4, n], mi[4, n] = u * x - v * y, u * y + v * x
        u, v = 2.0 * (cd - ab), 2.0 * (cy - ay)
        mr[5, n], mi[5, n] = u * x - v * y, u * y + v * x
        u, v = 2.0 * (bd - ac), 2.0 * (bz - az)
        mr[6, n], mi[6, n] = u * x - v * y, u * y + v * x
        u, v = 2.0 * (cd + ab), 2.0 * (cy + ay)
        mr[7, n], mi[7, n] = u * x - v * y, u * y + v * x
        u, v = aa - bb - cc + dd, ax - bx - cx + dx
        mr[8, n], mi[8, n] = u * x - v * y, u * y + v * x
        # q = 2 (e0 g - g0 e - e x g) / (e . e)
        x, y = 2.0 * x, 2.0 * y
        e, f, g, h = pr[4, n], pr[5, n], pr[6, n], pr[7, n]
        i, j, k, m = pi[4, n], pi[5, n], pi[6, n], pi[7, n]
        u = a * f - p * j - e * b + i * q - (c * h - r * m) + (d * g - s * k)
        v = a * j + p * f - e * q - i * b - (c * m + r * h) + (d * k + s * g)
        mr[9, n], mi[9, n] = u * x - v * y, u * y + v * x
        u = a * g - p * k - e * c + i * r - (d * f - s * j) + (b * h - q * m)
        v = a * k + p * g - e * r - i * c - (d * j + s * f) + (b * m + q * h)
        mr[10, n], mi[10, n] = u * x - v * y, u * y + v * x
        u = a * h - p * m - e * d + i * s - (b * g - q * k) + (c * f - r * j)
        v = a * m + p * h - e * s - i * d - (b * k + q * g) + (c * j + r * f)
        mr[11, n], mi[11, n] = u * x - v * y, u * y + v * x


@fused
def frame(pr, pi, A, B, mr, mi, ar, ai, Jr, Ji, rr, ri):
    """Write base points in the platform's frame, the rows J (6, 6), and -d . d / 4.

    A row is [d, b x d] with the vector d from the base point to the platform point b.
    """
    _turn(pr, pi, mr, mi)
    for k in range(6):
        x, y, z = A[k, 0], A[k, 1], A[k, 2]
        u, v, w = B[k, 0], B[k, 1], B[k, 2]
        for n in range(LANES):
            e = mr[0, n] * x + mr[3, n] * y + mr[6, n] * z - mr[9, n]
            f = mr[1, n] * x + mr[4, n] * y + mr[7, n] * z - mr[10, n]
            g = mr[2, n] * x + mr[5, n] * y + mr[8, n] * z - mr[11, n]
            i = mi[0, n] * x + mi[3, n] * y + mi[6, n] * z - mi[9, n]
            j = mi[1, n] * x + mi[4, n] * y + mi[7, n] * z - mi[10, n]
            m = mi[2, n] * x + mi[5, n] * y + mi[8, n] * z - mi[11, n]
            ar[k, 0, n], ar[k, 1, n], ar[k, 2, n] = e, f, g
            ai[k, 0, n], ai[k, 1, n], ai[k, 2, n] = i, j, m
            Jr[k, 3, n], Ji[k, 3, n] = f * w - g * v, j * w - m * v
            Jr[k, 4, n], Ji[k, 4, n] = g * u - e * w, m * u - i * w
            Jr[k, 5, n], Ji[k, 5, n] = e * v - f * u, i * v - j * u
            e, f, g = u - e, v - f, w - g
            Jr[k, 0, n], Jr[k, 1, n], Jr[k, 2, n] = e, f, g
            Ji[k, 0, n], Ji[k, 1, n], Ji[k, 2, n] = -i, -j, -m
            rr[k, n] = -0.25 * (e * e + f * f + g * g - i * i - j * j - m * m)
            ri[k, n] = 0.5 * (e * i + f * j + g * m)


@fused
def factor(Jr, Ji):
    """Replace J (6, 6) by its factors L U, with inverted pivots on the diagonal.

    There is no pivoting; corrections reveal the error of a pose with a small pivot.
    """
    for k in range(6):
        for n in range(LANES):
            x, y = Jr[k, k, n], Ji[k, k, n]
            size = 1.0 / (x * x + y * y)
            Jr[k, k, n], Ji[k, k, n] = x * size, -y * size
        for i in range(k + 1, 6):
            for n in range(LANES):
                x, y, u, v = Jr[i, k, n], Ji[i, k, n], Jr[k, k, n], Ji[k, k, n]
                Jr[i, k, n], Ji[i, k, n] = x * u - y * v, x * v + y * u
            for j in range(k + 1, 6):
                for n in range(LANES):
                    x, y, u, v = Jr[i, k, n], Ji[i, k, n], Jr[k, j, n], Ji[k, j, n]
                    Jr[i, j, n] -= x * u - y * v
                    Ji[i, j, n] -= x * v + y * u


@fused
def solve(Jr, Ji, xr, xi):
    """Overwrite x (6, LANES) with the solution by the factors of :func:`factor`."""
    for n in range(LANES):
        for i in range(1, 6):
            for k in range(i):
                x, y, u, v = Jr[i, k, n], Ji[i, k, n], xr[k, n], xi[k, n]
                xr[i, n] -= x * u - y * v
                xi[i, n] -= x * v + y * u
        for m in range(6):
            i = 5 - m
            for k in range(i + 1, 6):
                x, y, u, v = Jr[i, k, n], Ji[i, k, n], xr[k, n], xi[k, n]
                xr[i, n] -= x * u - y * v
                xi[i, n] -= x * v + y * u
            x, y, u, v = Jr[i, i, n], Ji[i, i, n], xr[i, n], xi[i, n]
            xr[i, n], xi[i, n] = x * u - y * v, x * v + y * u


@fused
def _product(pr, pi, i, qr, qi, j, n):
    """Return the product of the quaternions in rows i and j: four real, four imaginary parts."""
    a, b, c, d = pr[i, n], pr[i + 1, n], pr[i + 2, n], pr[i + 3, n]
    e, f, g, h = pi[i, n], pi[i + 1, n], pi[i + 2, n], pi[i + 3, n]
    p, q, r, s = qr[j, n], qr[j + 1, n], qr[j + 2, n], qr[j + 3, n]
    t, u, v, w = qi[j, n], qi[j + 1, n], qi[j + 2, n], qi[j + 3, n]
    return (
        (a * p - e * t) - (b * q - f * u) - (c * r - g * v) - (d * s - h * w),
        (a * q - e * u) + (b * p - f * t) + (c * s - g * w) - (d * r - h * v),
        (a * r - e * v) + (c * p - g * t) + (d * q - h * u) - (b * s - f * w),
        (a * s - e * w) + (d * p - h * t) + (b * r - f * v) - (c * q - g * u),
        (a * t + e * p) - (b * u + f * q) - (c * v + g * r) - (d * w + h * s),
        (a * u + e * q) + (b * t + f * p) + (c * w + g * s) - (d * v + h * r),
        (a * v + e * r) + (c * t + g * p) + (d * u + h * q) - (b * w + f * s),
        (a * w + e * s) + (d * t + h * p) + (b * v + f * r) - (c * u + g * q),
    )


@fused
def moved(pr, pi, xr, xi, sr, si, outr, outi):
    """Write poses moved by steps x = (tau, w) in their own frames; s (8, LANES) is scratch."""
    for n in range(LANES):
        a, b, c = xr[0, n], xr[1, n], xr[2, n]
        d, e, f = xi[0, n], xi[1, n], xi[2, n]
        u, v, w = xr[3, n], xr[4, n], xr[5, n]
        x, y, z = xi[3, n], xi[4, n], xi[5, n]
        sr[0, n], sr[1, n], sr[2, n], sr[3, n] = 1.0, u, v, w
        si[0, n], si[1, n], si[2, n], si[3, n] = 0.0, x, y, z
        sr[4, n] = -(a * u - d * x) - (b * v - e * y) - (c * w - f * z)
        si[4, n] = -(a * x + d * u) - (b * y + e * v) - (c * z + f * w)
        sr[5, n], sr[6, n], sr[7, n] = a, b, c
        si[5, n], si[6, n], si[7, n] = d, e, f
    for n in range(LANES):
        one = _product(pr, pi, 0, sr, si, 4, n)
        two = _product(pr, pi, 4, sr, si, 0, n)
        new = _product(pr, pi, 0, sr, si, 0, n)
        size = 0.0
        for i in range(8):
            size += new[i] * new[i]
        size = 1.0 / size**0.5
        for i in range(4):
            outr[i, n], outi[i, n] = size * new[i], size * new[4 + i]
            outr[4 + i, n] = size * (one[i] + two[i])
            outi[4 + i, n] = size * (one[4 + i] + two[4 + i])
