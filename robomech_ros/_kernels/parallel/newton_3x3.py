"""Newton steps with three unknowns, and collection of poses, for planar and spherical robots."""

from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.spatial.vectors import cramer, dot, scaled, upper

# Least determinant of a regular pose, relative to the product of row lengths.
REGULAR = 1e-6


@lean
def solve_three(J, f, step):
    """Solve J step = f by Cramer's rule; return det J over the product of row lengths."""
    determinant, found = cramer(upper(J, 0), upper(J, 1), upper(J, 2), f)
    size = (dot(J[0], J[0]) * dot(J[1], J[1]) * dot(J[2], J[2])) ** 0.5
    if not abs(determinant) > 1e-15 * size:
        return 0.0
    step[0], step[1], step[2] = scaled(found, 1.0 / determinant)
    return determinant / size


@lean
def gather(poses, multiplicity, count, same, regular):
    """Merge the pose in row ``count`` with an equal one before it; return the new count.

    Equal singular poses increase the multiplicity, equal regular ones do not.
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
