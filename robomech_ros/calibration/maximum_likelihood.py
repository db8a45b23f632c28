"""Maximum-likelihood fit of A_i X S_i = Z to samples, without those that contradict the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.calibration import refinement
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.calibration.free_directions import (
    FreeDirections,
    find_free_directions,
    rms_distance,
)
from robomech_ros.calibration.initial_guess import (
    MIN_VARIANCE,
    InitialGuess,
    closed_form_guess,
    median_variances,
    solve_about_axis,
    squared_residuals,
)
from robomech_ros.typing import Array, BoolArray

_refine = direct(refinement.refine)
_distances = direct(refinement.distances)

# Smaller sets of samples cannot separate the two noises, or outliers from inliers.
_MIN_FOR_SHARE, _MIN_FOR_OUTLIERS = 5, 5
# Squared distance, of six normal numbers, that one sample in 400,000 exceeds.
_OUTLIER = 36.0
# The same before the noise is known, by medians.
_GROSS_OUTLIER = 100.0
_MAX_ROUNDS = 10
# Samples with smaller residuals (rad, and the same fraction of the distances) are no outliers:
# this is rounding at the end, and the error of the initial guess for exact samples.
EXACT, _ROUGH = 1e-8, 1e-6
# The positions of so few samples may leave no residual to estimate their noise.  Their noise is
# then at least this fraction of rotation noise times target distance, as for most cameras.
FEW, _USUAL_POSITION_NOISE = 7, 0.1


@dataclass(eq=False)
class Fit:
    """Unknown poses X and Z (24,) and noise for samples in one convention, refined in place.

    A and S (n, 12) are the poses of A X S = Z, as :func:`pack_poses` returns them; the side is 0
    for a sensor in the hand, 1 for one next to the robot. The noise (3,), which is known if the
    caller specified it, has the variance of rotations (rad^2) and positions (m^2), and the robot's
    fraction of the former. ``use`` (n,) is 1 for inliers, 0 for outliers; the information is (12,
    12).
    """

    A: Array
    S: Array
    side: int
    known: bool
    guess: InitialGuess
    at: Array
    noise: Array
    use: Array
    information: Array
    free: FreeDirections

    @classmethod
    def from_guess(
        cls, A: Array, S: Array, consistent: Array, side: int, variances: Array | None
    ) -> Fit:
        """Return the initial guess as a fit; variances (3,) are the noise if it is known."""
        guess = closed_form_guess(A, S, consistent, 0.0 if variances is None else variances[0])
        noise = np.array([*guess.variances, 0.0]) if variances is None else variances.copy()
        use, information = np.ones(len(A)), np.zeros((12, 12))
        known = variances is not None
        return cls(A, S, side, known, guess, guess.at.copy(), noise, use, information, guess.free)

    def residuals(self) -> Array:
        """Return squared rotation (rad^2) and position residuals (m^2), shape (2, n)."""
        return squared_residuals(self.A, self.S, self.at)

    def distances(self, at: Array) -> Array:
        """Return squared distances (n,) of the samples from unknowns, in deviations of noise."""
        squares = np.empty(len(self.A))
        _distances(self.A, self.S, at, self.noise, self.side, squares)
        return squares

    def step(self, at: Array, noise: Array, *, known: bool, shared: bool = False) -> None:
        """Refine unknowns and noise in place for the present inliers; write the information."""
        fixed, information = self.free.constraint, self.information
        _refine(self.A, self.S, self.use, at, noise, fixed, self.side, known, shared, information)

    def refine(self, robust: bool) -> None:
        """Refine until the outliers stay the same, then find the free directions by the noise."""
        self._refine_until_settled(robust)
        residuals = self.residuals()
        variance = float(self.use @ residuals[0]) / (3.0 * self.use.sum() - 6.0)
        if not robust:
            variance = min(variance, median_variances(residuals)[0])
        variance = max(variance, MIN_VARIANCE, float(self.noise[0]) if self.known else 0.0)
        before = self.free.is_axis
        self.free = find_free_directions(self.A, self.S, self.use, self.at, variance)
        if self.free.is_axis and not before:
            self.at = self.guess.at.copy()
            solve_about_axis(self.A, self.S, self.use, self.at, self.free)
            if not self.known:
                self.noise[:2] = median_variances(self.residuals())
        if self.free.is_axis or before:
            self._refine_until_settled(robust)

    def _refine_until_settled(self, robust: bool) -> None:
        reject = robust and len(self.A) >= _MIN_FOR_OUTLIERS
        if reject:
            for _ in range(_MAX_ROUNDS):
                residuals = self.residuals()
                turn, shift = median_variances(residuals)
                gross = residuals[0] / turn + residuals[1] / shift > _GROSS_OUTLIER
                if not self._exclude(gross & ~self._within(_ROUGH, residuals)):
                    break
                self.step(self.at, self.noise, known=self.known)
        for _ in range(_MAX_ROUNDS):
            shared = not self.known and bool(self.use.sum() >= _MIN_FOR_SHARE)
            self.step(self.at, self.noise, known=self.known, shared=shared)
            outlying = self.distances(self.at) > _OUTLIER
            if not reject or not (outlying.any() or self.use.min() < 1.0):
                break
            if not self._exclude(outlying & ~self._within(EXACT, self.residuals())):
                break
        self._bound_position_noise()

    def _bound_position_noise(self) -> None:
        """Refine again if the position noise of few samples vanished.

        Positions without noise would determine the rotations, too, and without any error.
        """
        if self.known or self.use.sum() > FEW:
            return
        distance = rms_distance(self.S[self.use > 0.0])
        least = _USUAL_POSITION_NOISE**2 * distance**2 * float(self.noise[0])
        if self.noise[1] < least:
            self.noise[1] = least
            self.step(self.at, self.noise, known=True)

    def _within(self, limit: float, residuals: Array) -> BoolArray:
        """Return which residuals are below an angle (rad) and that fraction of the distances."""
        scale = 1.0 + (rms_distance(self.A) ** 2 + rms_distance(self.S) ** 2) / 3.0
        return np.asarray((residuals[0] < limit**2) & (residuals[1] < limit**2 * scale))

    def _exclude(self, outliers: BoolArray) -> bool:
        """Exclude outliers unless they are half of the samples; return whether they changed."""
        if 2 * outliers.sum() >= len(outliers):
            return False
        use = np.where(outliers, 0.0, 1.0)
        changed = not np.array_equal(use, self.use)
        self.use = use
        return changed
