"""Levelling, Gaussian filters and slopes of surfaces."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIGMA_OF_CUTOFF = math.sqrt(math.log(2.0) / 2.0) / math.pi
"""Standard deviation of the Gaussian weighting function over its cutoff wavelength, 0.1874.

A sine of the cutoff wavelength keeps half its height: exp(-2 (π σ / λ)²) = 1/2 [ISO16610-21, eq. 1].
"""

STENCIL = 3
"""Points on either side of a slope."""

_COEFFICIENTS = (45.0, -9.0, 1.0)


def levelled(z: Array) -> Array:
    """`z` less its least-squares line (profile) or plane (map). NaN stays NaN."""
    axes = [np.linspace(-1.0, 1.0, n) for n in z.shape]
    terms = [np.ones_like(z), *np.meshgrid(*axes, indexing="ij")]
    measured = np.isfinite(z)
    design = np.stack([t[measured] for t in terms], axis=1)
    heights = z[measured]
    # The normal equations of three nearly orthogonal terms lose nothing, and need no copy of a large map.
    coefficients = np.linalg.solve(design.T @ design, design.T @ heights)
    fitted: Array = z - sum(c * t for c, t in zip(coefficients, terms, strict=True))
    return fitted


def gaussian(z: Array, *, cutoff: float, steps: tuple[float, ...]) -> Array:
    """Gaussian filter of cutoff wavelength `cutoff` along each axis [ISO16610-21], [ISO16610-61].

    The weights that fall outside the surface or on NaN are left out and the others scaled up, so that NaN is
    filled from its neighbours. `steps` are those of the axes, in the unit of `cutoff`. The weighting function
    reaches one cutoff to either side.
    """
    # Imported here: scipy takes longer to load than all the rest of the command line.
    from scipy.ndimage import gaussian_filter1d  # noqa: PLC0415

    measured = np.isfinite(z)
    top = np.where(measured, z, 0.0)
    bottom = measured.astype(np.float64)
    for axis, step in enumerate(steps):
        sigma = SIGMA_OF_CUTOFF * cutoff / step
        options = {"axis": axis, "mode": "constant", "truncate": 1.0 / SIGMA_OF_CUTOFF}
        top = gaussian_filter1d(top, sigma, **options)
        bottom = gaussian_filter1d(bottom, sigma, **options)
    with np.errstate(invalid="ignore", divide="ignore"):
        filtered: Array = np.where(bottom > 1e-6, top / bottom, np.nan)
    return filtered


def slope(z: Array, *, axis: int, step: float) -> Array:
    """Slope along `axis` from seven points [ISO21920-2].

    `(z₃ - 9 z₂ + 45 z₁ - 45 z₋₁ + 9 z₋₂ - z₋₃) / (60 step)`, exact for polynomials up to the sixth degree.
    The result is shorter by three points at either end of `axis`; NaN where one of the seven is NaN.
    """
    n = z.shape[axis]
    result: Array = np.zeros_like(_window(z, axis, STENCIL, n - STENCIL))
    for k, c in enumerate(_COEFFICIENTS, start=1):
        ahead = _window(z, axis, STENCIL + k, n - STENCIL + k)
        behind = _window(z, axis, STENCIL - k, n - STENCIL - k)
        result += (c / 60.0) * (ahead - behind)
    return result / step


def slopes(z: Array, *, dx: float, dy: float | None) -> list[Array]:
    """Slopes (along x; and along y of a map), at the points that have both."""
    if dy is None:
        return [slope(z, axis=0, step=dx)]
    inner = slice(STENCIL, -STENCIL)
    return [slope(z[inner, :], axis=1, step=dx), slope(z[:, inner], axis=0, step=dy)]


def correlation_length(z: Array, *, axis: int, step: float) -> float | None:
    """Lag along `axis` at which the autocorrelation has fallen to 1/e.

    None when it does not fall so far within half the length. Products of points a lag apart are averaged over
    all lines and over the pairs of which both points are measured.
    """
    lines = np.moveaxis(z, axis, -1).reshape(-1, z.shape[axis])
    measured = np.isfinite(lines)
    filled = np.where(measured, lines, 0.0)
    n = lines.shape[-1]
    size = 2 ** math.ceil(math.log2(2 * n))
    power = np.zeros(size // 2 + 1)
    pairs = np.zeros(size // 2 + 1)
    # A line at a time keeps the memory at one map; a line is one vectorised transform.
    for top, weight in zip(filled, measured, strict=True):
        power += np.abs(np.fft.rfft(top, size)) ** 2
        pairs += np.abs(np.fft.rfft(weight.astype(np.float64), size)) ** 2
    half = n // 2
    covariance = np.fft.irfft(power, size)[:half] / np.maximum(np.fft.irfft(pairs, size)[:half], 0.5)
    below = np.flatnonzero(covariance < covariance[0] / math.e)
    if not len(below):
        return None
    k = int(below[0])
    target = covariance[0] / math.e
    part = (covariance[k - 1] - target) / (covariance[k - 1] - covariance[k])
    return float((k - 1 + part) * step)


def _window(z: Array, axis: int, start: int, stop: int) -> Array:
    return z[(slice(None),) * axis + (slice(start, stop),)]
