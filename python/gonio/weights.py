"""Solid-angle weights and hemispherical integrals of scattered directions.

The weights are exact spherical Voronoi cells of the hemisphere; the integral fits quadratics over them and
states its own quadrature uncertainty. docs/validation/weights.md shows its errors.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gonio import _native

__all__ = ["Integral", "Weights", "hemisphere_integral", "hemisphere_weights"]


@dataclass(frozen=True)
class Weights:
    """Voronoi cells of directions of one hemisphere, in the order of the directions."""

    omega: NDArray[np.float64]
    """Solid angle of each cell, sr; the sum is 2 pi."""
    omega_projected: NDArray[np.float64]
    """Projected solid angle, the integral of |cos theta_s| over each cell, sr; the sum is pi."""
    reach: NDArray[np.float64]
    """Angle from each direction to the farthest corner of its cell, degrees."""


@dataclass(frozen=True)
class Integral:
    """The integral of a DSF over one hemisphere; uncertainties are standard uncertainties."""

    value: float
    """DHR or DHT, extrapolated part included."""
    extrapolated: float
    """The part from directions farther than `reach` from every reading."""
    u_noise: float
    """From the noise of the readings."""
    u_quadrature: float
    """From reading at these directions only, extrapolation included."""
    u_extrapolated: float
    """The share of `u_quadrature` that comes from the extrapolated part."""
    u_peaks: float
    """The share of `u_quadrature` that comes from peaks on which few readings stand."""
    measured_omega: float
    """Solid angle within reach of a reading, sr (of 2 pi)."""
    reach: float
    """How far from a reading a direction counts as measured, degrees."""


def hemisphere_weights(theta_s: ArrayLike, phi_s: ArrayLike, *, side: str) -> Weights:
    """Exact Voronoi weights of directions of one hemisphere, the same direction sharing its cell equally.

    `theta_s` in [0, 180] and `phi_s` in degrees, 1-D and equally long; any number from one, anywhere on
    `side` (`"front"`: theta_s <= 90, `"back"`: theta_s >= 90). Raises `DomainError` for anything else.
    """
    return Weights(*_native.hemisphere_weights(theta_s, phi_s, side=side))


def hemisphere_integral(
    theta_s: ArrayLike,
    phi_s: ArrayLike,
    dsf: ArrayLike,
    *,
    side: str,
    incidence: tuple[float, float] | None = None,
    u_dsf: ArrayLike | None = None,
    reach: float | None = None,
) -> Integral:
    """Integrate a DSF [1/sr] read at scattered directions of one hemisphere.

    `incidence` is (theta_i, phi_i) in degrees and helps to fill gaps; `u_dsf` is the standard uncertainty of
    each value from noise; `reach` in degrees is how far a reading counts (default: twice the reach of the
    typical cell, 1 to 8). Readings above 89.5 degrees from the normal are left out. Raises `DomainError` for
    values that are not finite, columns of unequal length or directions of the other side.
    """
    found = _native.hemisphere_integral(
        theta_s, phi_s, dsf, side=side, incidence=incidence, u_dsf=u_dsf, reach=reach
    )
    return Integral(**found)
