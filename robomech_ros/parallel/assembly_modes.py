"""All poses of a platform on six legs of given lengths, with their certificate."""

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.parallel import ends as ends_of_paths, length_homotopy, projective
from robomech_ros._kernels.parallel.newton import read_parameters
from robomech_ros.outcomes import Code
from robomech_ros.parallel.homotopy_failures import SingularEnds, least_squares, singular_ends
from robomech_ros.parallel.platform_geometry import ScaledPlatform
from robomech_ros.parallel.result import DirectKinematicsResult
from robomech_ros.parallel.start_system import StartSystem
from robomech_ros.parallel.study import quadrics_between
from robomech_ros.typing import Array, ComplexArray, IntArray

_track = direct(length_homotopy.track_lengths)
_pair = direct(ends_of_paths.pair)
_real_poses = direct(ends_of_paths.real_poses)

# A path that has come so far has an end that can be looked at.
_NEARLY_THERE = 1.0 - 1e-4
# From how many complex poses the nearest real one is sought.
_NEAREST_STARTS = 12
CONTINUUM = "the platform can move while its legs are locked"


def assembly_modes(
    scaled: ScaledPlatform, start: StartSystem, lengths: Array, family: str
) -> DirectKinematicsResult:
    """Find all poses for leg lengths (6,) in m."""
    n = len(start.poses)
    short = scaled.scale * lengths
    squares = short * short
    x, partner = start.poses.copy(), np.empty(n, np.int64)
    ends, times = np.empty(n, np.int64), np.empty(n)
    _track(scaled.a, scaled.b, start.squares, squares.astype(np.complex128), x, ends, times)
    singular = SingularEnds()
    if _pair(x, ends, partner):
        singular = _tried_again(scaled, start, squares, (x, ends, partner))
    found, errors = np.empty((n, 12)), np.empty(n)
    count = _real_poses(scaled.a, scaled.b, short, x, partner, found, errors)
    doubts = [start.doubt] if start.doubt else []
    if count < 0:
        count = 0
        doubts.append("a real pose cannot be made exact")
    if singular.unexplained:
        doubts.append(f"{singular.unexplained} of {n} paths end without a verdict")
    multiplicity = np.ones(count + len(singular.poses), np.int64)
    if singular.poses:
        found = np.concatenate((found[:count], singular.poses))
        multiplicity[count:] = singular.multiplicity
    poses = scaled.poses(found[: len(multiplicity)])
    residuals = np.zeros(len(poses))
    residuals[:count] = errors[:count] / scaled.scale
    status, reason = _verdict(scaled, short, x, multiplicity, singular, doubts)
    complete = not doubts and not any(singular.movable)
    return DirectKinematicsResult(poses, multiplicity, complete, family, status, reason, residuals)


def _verdict(
    scaled: ScaledPlatform,
    lengths: Array,
    x: ComplexArray,
    multiplicity: IntArray,
    singular: SingularEnds,
    doubts: list[str],
) -> tuple[Code, str]:
    if any(singular.movable):
        return Code.SINGULAR_CONTINUUM, CONTINUUM
    if doubts:
        return Code.NOT_CONVERGED, "poses may be missing: " + "; ".join(doubts)
    if len(multiplicity) == 0:
        return Code.OUT_OF_REACH, "no real pose: " + _how_near(scaled, lengths, x)
    if multiplicity.max() > 1:
        count = int((multiplicity > 1).sum())
        noun = "pose is" if count == 1 else "poses are"
        return Code.NONE, f"{count} {noun} singular: assembly modes meet there"
    return Code.NONE, ""


def _tried_again(
    scaled: ScaledPlatform,
    start: StartSystem,
    squares: Array,
    state: tuple[ComplexArray, IntArray, IntArray],
) -> SingularEnds:
    """Follow paths without a partner once more, in P^7; what still has none, look at it."""
    x, ends, partner = state
    alone = np.flatnonzero(partner < 0)
    y = start.poses[alone]
    again, times = np.empty(len(alone), np.int64), np.empty(len(alone))
    one, two = quadrics_between(scaled.a, scaled.b, start.squares, squares)
    projective.track(one, two, y, again, times)
    x[alone], ends[alone] = y, again
    if not _pair(x, ends, partner):
        return SingularEnds()
    reached = np.ones(len(x))
    reached[alone] = times
    late = (ends != projective.REGULAR) & (reached > _NEARLY_THERE)
    found = singular_ends(scaled.a, scaled.b, squares, x[late])
    found.unexplained += int(((partner < 0) & ~late).sum())
    return found


def _how_near(scaled: ScaledPlatform, lengths: Array, x: ComplexArray) -> str:
    """Say how near a real pose comes to the lengths, by least squares from complex ones."""
    norms = np.sqrt((x[:, :4] * x[:, :4]).sum(axis=1))
    x = x[np.abs(norms) > 0.0] / norms[np.abs(norms) > 0.0, None]
    least, missed = np.inf, np.zeros(6)
    for i in np.argsort(np.abs(x.imag).sum(axis=1))[:_NEAREST_STARTS]:
        pose = np.empty(12)
        read_parameters(np.ascontiguousarray(x[i].real), pose)
        error = least_squares(scaled.a, scaled.b, lengths, pose)
        if (error @ error) < least:
            least, missed = float(error @ error), error / scaled.scale
    leg = int(np.argmax(np.abs(missed)))
    return (
        f"the nearest one found misses the lengths by up to {abs(missed[leg]):.3g} m "
        f"(leg {leg + 1}), {float(np.sqrt((missed * missed).mean())):.3g} m in the mean"
    )
