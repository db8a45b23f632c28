"""Newton steps of the planar and the spherical robot: three equations in three unknowns."""

from robomech_ros._kernels.compiling.jit import lean

# Least determinant, of the product of the rows' lengths, of a regular pose.
REGULAR = 1e-6


@lean
def solve_three(J, f, step):
    """Solve J step = f by Cramer's rule; give the determinant over the product of row lengths."""
    a, b, c = J[0, 0], J[0, 1], J[0, 2]
    d, e, g = J[1, 0], J[1, 1], J[1, 2]
    h, i, j = J[2, 0], J[2, 1], J[2, 2]
    p, q, r = e * j - g * i, g * h - d * j, d * i - e * h
    determinant = a * p + b * q + c * r
    size = ((a * a + b * b + c * c) * (d * d + e * e + g * g) * (h * h + i * i + j * j)) ** 0.5
    if not abs(determinant) > 1e-15 * size:
        return 0.0
    x, y, z = f[0] / determinant, f[1] / determinant, f[2] / determinant
    step[0] = p * x + (c * i - b * j) * y + (b * g - c * e) * z
    step[1] = q * x + (a * j - c * h) * y + (c * d - a * g) * z
    step[2] = r * x + (b * h - a * i) * y + (a * e - b * d) * z
    return determinant / size


@lean
def gather(poses, multiplicity, count, same, regular):
    """Merge the pose at row ``count`` with one before it, or keep it; give how many there are.

    A regular pose is a single one, however often it was found.
    """
    for k in range(count):
        apart = 0.0
        for j in range(poses.shape[1]):
            apart = max(apart, abs(poses[k, j] - poses[count, j]))
        if apart <= same:
            if not regular:
                multiplicity[k] += 1
            return count
    multiplicity[count] = 1
    return count + 1
