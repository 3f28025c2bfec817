"""Surface profiles and height maps to the width of a micro-facet lobe."""

from __future__ import annotations

import math
import os
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gonio._native import DomainError, FormatError
from gonio.surface_files import UNITS, Surface, check_surface, read_surface, two_steps
from gonio.surface_filters import correlation_length, gaussian, levelled, slopes

Array = NDArray[np.float64]

_STILL_GROWING = 1.2
_KURTOSIS = 0.5
_STEPS_A_CUTOFF = 4.0
_COHERENT = 0.01
_LENGTHS_A_BLOCK = 10.0
_LENGTH_DIFFERENCE = 0.2
_ANISOTROPY = 0.05


@dataclass(frozen=True)
class Roughness:
    """Roughness of a surface and the lobe width that goes with it.

    Lengths are micrometres, uncertainties standard ones (k = 1).

    Attributes
    ----------
    kind
        `profile` or `map`.
    points, spacing
        Points and step along each axis: (x) or (x, y).
    lambda_s, lambda_c
        Cutoff wavelengths of the Gaussian filters, None where none was used.
    shortest, longest
        The wavelengths that the figures hold: `lambda_s` or two steps, and `lambda_c` or the evaluated
        length.
    rms, u_rms
        RMS roughness: R_q of a profile, S_q of a map.
    rms_slope, u_rms_slope
        RMS slope: R_dq of a profile, S_dq of a map.
    alpha, u_alpha
        Width of the lobe of an isotropic surface: S_dq, and √2 R_dq.
    alpha_x, alpha_y, u_alpha_x, u_alpha_y
        Widths along and across `direction`; of a profile both are `alpha`.
    direction
        Azimuth of the steepest axis from x towards y, 0 to 180 degrees; None of a profile.
    anisotropic
        Whether `alpha_x` and `alpha_y` differ by more than 5 % and three standard uncertainties; None of a
        profile.
    correlation_length
        Lags along each axis at which the autocorrelation falls to 1/e; None where it does not.
    alpha_of_length
        What `alpha` would be of a surface of Gaussian autocorrelation, from `rms` and `correlation_length`.
    slope_kurtosis
        Excess kurtosis of the slopes, 0 of Gaussian slopes; the largest of the axes.
    slope_growth
        RMS slope over the one from every other point: 1 when the sampling is fine enough.
    wavelength
        Of the light, nm.
    coherent
        Share of the reflected light that Gaussian heights of `rms` leave in the mirror direction at normal
        incidence, exp(-(4 π rms / wavelength)²) [BennettPorteus1961, eq. 1].
    blocks
        Blocks that the uncertainties come from.
    warnings
        What speaks against the figures.
    """

    kind: Literal["profile", "map"]
    points: tuple[int, ...]
    spacing: tuple[float, ...]
    lambda_s: float | None
    lambda_c: float | None
    shortest: float
    longest: float
    rms: float
    u_rms: float
    rms_slope: float
    u_rms_slope: float
    alpha: float
    u_alpha: float
    alpha_x: float
    alpha_y: float
    u_alpha_x: float
    u_alpha_y: float
    direction: float | None
    anisotropic: bool | None
    correlation_length: tuple[float | None, ...]
    alpha_of_length: float | None
    slope_kurtosis: float
    slope_growth: float
    wavelength: float
    coherent: float
    blocks: int
    warnings: list[str] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as `gonio roughness --json` prints them."""
        return asdict(self)


def roughness(
    source: str | os.PathLike[str] | ArrayLike,
    *,
    spacing: float | tuple[float, float] | None = None,
    x_unit: str | None = None,
    z_unit: str | None = None,
    lambda_s: float | None = None,
    lambda_c: float | None = None,
    level: bool = True,
    blocks: int | None = None,
    wavelength: float = 550.0,
) -> Roughness:
    """RMS roughness, RMS slope and lobe width of a surface profile or height map.

    The width of the micro-facet and Ward models is an RMS slope, not a height: `alpha = S_dq = √2 R_dq`, of a
    surface of Gaussian autocorrelation σ² exp(-x² / τ²) it is 2 σ / τ [Beckmann1963], [Walter2007]. The often
    quoted √2 σ / τ is the slope of a profile. A profile tells alpha of an isotropic surface; across a lay it
    tells alpha along the profile only.

    The surface is levelled by its least-squares line or plane, filtered by Gaussians [ISO16610-21],
    [ISO16610-61], and, with a filter, evaluated without a margin of half the longer cutoff. Slopes come from
    seven points [ISO21920-2], [ISO25178-2]. Uncertainties are those of a finite sample: the scatter of the
    mean squares over equal blocks, over the root of their number. Instrument and calibration add to them.

    Parameters
    ----------
    source
        A file as in `gonio.surface_files.read_surface`, or heights: (n,) or (rows, columns), NaN where not
        measured.
    spacing, x_unit, z_unit
        As in `read_surface`. Heights in an array need all three.
    lambda_s, lambda_c
        Cutoff wavelengths in micrometres: what is shorter than `lambda_s` and longer than `lambda_c` is
        removed. Four steps (where the sampled weighting function is still that of the standard) to half the
        surface.
    level
        Remove the line or plane; otherwise only the mean.
    blocks
        Blocks along each axis, 2 to 64; 8 of a profile and 4 of a map unless stated.
    wavelength
        Of the light in nm, for the warning about smooth surfaces.

    Raises
    ------
    FormatError, OSError
        As `read_surface`.
    DomainError
        A parameter out of its range, or a cutoff that the surface cannot carry.
    """
    if isinstance(source, (str, os.PathLike)):
        surface = read_surface(source, spacing=spacing, x_unit=x_unit, z_unit=z_unit)
    else:
        surface = _surface_of_array(source, spacing, x_unit, z_unit)
    if not 10.0 <= wavelength <= 1e6:
        raise DomainError(f"wavelength: found {wavelength:g}, allowed 10 to 1e6 nm")
    if blocks is None:
        blocks = 4 if surface.is_map else 8
    if not 2 <= blocks <= 64:
        raise DomainError(f"blocks: found {blocks}, allowed 2 to 64")
    _check_cutoffs(surface, lambda_s, lambda_c)
    z = _filtered(surface, lambda_s, lambda_c, level)
    return _evaluate(surface, z, cutoffs=(lambda_s, lambda_c), blocks=blocks, wavelength=wavelength)


def _surface_of_array(
    source: ArrayLike, spacing: float | tuple[float, float] | None, x_unit: str | None, z_unit: str | None
) -> Surface:
    z = np.asarray(source, dtype=np.float64)
    if z.ndim not in (1, 2) or np.isinf(z).any():
        raise FormatError(f"heights: found an array of {z.ndim} dimensions, allowed finite numbers in 1 or 2")
    steps = two_steps(spacing)
    if steps is None or x_unit is None or z_unit is None:
        raise DomainError("heights in an array: found no spacing, x_unit or z_unit, allowed all three stated")
    for name, unit in (("x_unit", x_unit), ("z_unit", z_unit)):
        if unit not in UNITS:
            raise DomainError(f"{name}: found {unit!r}, allowed {', '.join(UNITS)}")
    dx, dy = (s * UNITS[x_unit] for s in steps)
    surface = Surface(z * UNITS[z_unit], dx, dy if z.ndim == 2 else None)
    check_surface(surface)
    return surface


def _steps(surface: Surface) -> tuple[float, ...]:
    """Steps of the array's axes, in their order."""
    return (surface.dx,) if surface.dy is None else (surface.dy, surface.dx)


def _check_cutoffs(surface: Surface, lambda_s: float | None, lambda_c: float | None) -> None:
    steps = _steps(surface)
    shortest = _STEPS_A_CUTOFF * max(steps)
    longest = min(n * step for n, step in zip(surface.z.shape, steps, strict=True)) / 2.0
    for name, value in (("lambda_s", lambda_s), ("lambda_c", lambda_c)):
        if value is not None and not shortest <= value <= longest:
            raise DomainError(
                f"{name}: found {value:g}, allowed {shortest:g} to {longest:g} um for this surface (four "
                "steps to half of it)"
            )
    if lambda_s is not None and lambda_c is not None and lambda_s >= lambda_c:
        raise DomainError(f"lambda_s: found {lambda_s:g}, allowed less than lambda_c {lambda_c:g}")


def _filtered(surface: Surface, lambda_s: float | None, lambda_c: float | None, level: bool) -> Array:
    steps = _steps(surface)
    z: Array = levelled(surface.z) if level else surface.z - np.nanmean(surface.z)
    measured = np.isfinite(z)
    if lambda_s is not None:
        z = gaussian(z, cutoff=lambda_s, steps=steps)
    if lambda_c is not None:
        z = z - gaussian(z, cutoff=lambda_c, steps=steps)
    z = np.where(measured, z, np.nan)
    longer = lambda_c or lambda_s
    if longer is not None:
        margins = [math.ceil(longer / 2.0 / step) for step in steps]
        z = z[tuple(slice(m, n - m) for m, n in zip(margins, z.shape, strict=True))]
    return z


def _evaluate(
    surface: Surface,
    z: Array,
    *,
    cutoffs: tuple[float | None, float | None],
    blocks: int,
    wavelength: float,
) -> Roughness:
    lambda_s, lambda_c = cutoffs
    gradient = slopes(z, dx=surface.dx, dy=surface.dy)
    if not z.size or not gradient[0].size or not np.isfinite(sum(gradient)).any():
        raise DomainError(
            f"{surface.path or 'surface'}: found no seven measured points in a row after the margins of the "
            "filter, "
            "allowed a longer surface, fewer gaps or a shorter cutoff"
        )
    rms, u_rms = _rms(z**2, blocks)
    rms_slope, u_rms_slope = _rms(sum((g**2 for g in gradient), np.zeros_like(gradient[0])), blocks)
    lengths = _lengths(surface, z)
    direction: float | None = None
    anisotropic: bool | None = None
    if surface.is_map:
        alpha, u_alpha = rms_slope, u_rms_slope
        direction, (alpha_x, u_x), (alpha_y, u_y) = _axes(gradient, blocks)
        apart = alpha_x - alpha_y
        anisotropic = apart > _ANISOTROPY * alpha and apart > 3.0 * math.hypot(u_x, u_y)
    else:
        alpha, u_alpha = math.sqrt(2.0) * rms_slope, math.sqrt(2.0) * u_rms_slope
        alpha_x = alpha_y = alpha
        u_x = u_y = u_alpha
    steps = _steps(surface)
    extent = min(n * step for n, step in zip(z.shape, steps, strict=True))
    result = Roughness(
        kind="map" if surface.is_map else "profile",
        points=surface.z.shape[::-1],
        spacing=steps[::-1],
        lambda_s=lambda_s,
        lambda_c=lambda_c,
        shortest=lambda_s or 2.0 * max(steps),
        longest=lambda_c or extent,
        rms=rms,
        u_rms=u_rms,
        rms_slope=rms_slope,
        u_rms_slope=u_rms_slope,
        alpha=alpha,
        u_alpha=u_alpha,
        alpha_x=alpha_x,
        alpha_y=alpha_y,
        u_alpha_x=u_x,
        u_alpha_y=u_y,
        direction=direction,
        anisotropic=anisotropic,
        correlation_length=lengths,
        alpha_of_length=_alpha_of_length(rms, lengths),
        slope_kurtosis=max((_excess_kurtosis(g) for g in gradient), key=abs),
        slope_growth=_slope_growth(surface, z, rms_slope),
        wavelength=wavelength,
        coherent=math.exp(-((4.0 * math.pi * rms / (wavelength * 1e-3)) ** 2)),
        blocks=blocks**z.ndim,
    )
    measured = float(np.isfinite(surface.z).mean())
    if measured < 1.0:
        result.warnings.append(
            f"{100 * (1 - measured):.2g} % of the points were not measured and are left out"
        )
    result.warnings.extend(_warnings(result, extent / blocks))
    return result


def _rms(square: Array, blocks: int) -> tuple[float, float]:
    """Root of the mean of `square` and its standard uncertainty from blocks."""
    mean = float(np.nanmean(square))
    parts = [square]
    for axis in range(square.ndim):
        parts = [p for part in parts for p in np.array_split(part, blocks, axis=axis)]
    means = np.array([np.nanmean(p) for p in parts if np.isfinite(p).any()])
    rms = math.sqrt(mean)
    if len(means) < 2 or rms == 0.0:
        return rms, math.nan
    return rms, float(means.std(ddof=1)) / math.sqrt(len(means)) / (2.0 * rms)


def _axes(gradient: list[Array], blocks: int) -> tuple[float, tuple[float, float], tuple[float, float]]:
    """Azimuth of the steepest axis in degrees, and alpha with uncertainty along and across it."""
    x, y = gradient
    matrix = np.array([[np.nanmean(x * x), np.nanmean(x * y)], [np.nanmean(x * y), np.nanmean(y * y)]])
    _, vectors = np.linalg.eigh(matrix)
    along = vectors[:, 1]
    widths = []
    for c, s in (along, (-along[1], along[0])):
        rms, u = _rms(2.0 * (c * x + s * y) ** 2, blocks)
        widths.append((rms, u))
    return math.degrees(math.atan2(along[1], along[0])) % 180.0, widths[0], widths[1]


def _lengths(surface: Surface, z: Array) -> tuple[float | None, ...]:
    """Correlation lengths along x (and y)."""
    found = [correlation_length(z, axis=k, step=step) for k, step in enumerate(_steps(surface))]
    return tuple(reversed(found))


def _alpha_of_length(rms: float, lengths: tuple[float | None, ...]) -> float | None:
    """2 σ / τ of a surface of Gaussian autocorrelation; of two lengths the mean of their inverse squares."""
    known = [t for t in lengths if t is not None]
    if len(known) < len(lengths):
        return None
    return 2.0 * rms * math.sqrt(sum(t**-2 for t in known) / len(known))


def _excess_kurtosis(values: Array) -> float:
    finite = values[np.isfinite(values)]
    centred = finite - finite.mean()
    variance = float((centred**2).mean())
    return float((centred**4).mean()) / variance**2 - 3.0 if variance > 0.0 else 0.0


def _slope_growth(surface: Surface, z: Array, rms_slope: float) -> float:
    """RMS slope over that of every other point, NaN where too few are left."""
    thinned = z[(slice(None, None, 2),) * z.ndim]
    if min(thinned.shape) < 8:
        return math.nan
    coarse = slopes(thinned, dx=2.0 * surface.dx, dy=None if surface.dy is None else 2.0 * surface.dy)
    square = sum((g**2 for g in coarse), np.zeros_like(coarse[0]))
    return rms_slope / math.sqrt(float(np.nanmean(square))) if np.isfinite(square).any() else math.nan


def _warnings(r: Roughness, block: float) -> list[str]:
    found = []
    if r.lambda_s is None:
        found.append(
            f"no lambda_s: slopes hold everything down to two steps ({r.shortest:.3g} um), the instrument's "
            "noise included; "
            "state lambda_s, and state it with alpha"
        )
    if r.slope_growth > _STILL_GROWING:
        found.append(
            f"the slopes are undersampled: {r.rms_slope:.3g} from all points, "
            f"{r.rms_slope / r.slope_growth:.3g} from every "
            "other one; alpha grows with finer sampling (noise does so, too): sample finer or state a longer "
            "lambda_s"
        )
    if r.coherent > _COHERENT:
        found.append(
            f"RMS roughness {1000 * r.rms:.3g} nm leaves {100 * r.coherent:.2g} % of the reflected light at "
            f"{r.wavelength:g} nm in the mirror direction: a micro-facet lobe of this alpha is to be "
            "expected of the rest at most"
        )
    known = [t for t in r.correlation_length if t is not None]
    if len(known) < len(r.correlation_length):
        found.append(
            "the autocorrelation does not fall to 1/e within half of the surface: RMS roughness depends on "
            "its size; "
            "state lambda_c"
        )
    elif block < _LENGTHS_A_BLOCK * max(known):
        found.append(
            f"a block ({block:.3g} um) is shorter than {_LENGTHS_A_BLOCK:g} correlation lengths "
            f"({max(known):.3g} um): the "
            "uncertainties are too small; measure a larger area or ask for fewer blocks"
        )
    if r.alpha_of_length and abs(r.alpha_of_length / r.alpha - 1.0) > _LENGTH_DIFFERENCE:
        found.append(
            f"2 sigma / tau gives {r.alpha_of_length:.3g}, the slopes {r.alpha:.3g}: the autocorrelation is "
            "not Gaussian, "
            "and alpha depends on the bandwidth"
        )
    cells = (
        math.prod(n * s / t for n, s, t in zip(r.points, r.spacing, known, strict=False)) if known else 1.0
    )
    if abs(r.slope_kurtosis) > max(_KURTOSIS, 3.0 * math.sqrt(24.0 / max(cells, 1.0))):
        tail = "heavier tails, as in GGX" if r.slope_kurtosis > 0.0 else "lighter tails"
        found.append(
            f"the slopes are not Gaussian (excess kurtosis {r.slope_kurtosis:.2g}): {tail} than in the "
            "Beckmann and Ward lobes"
        )
    if r.anisotropic:
        found.append(
            f"the surface is anisotropic: alpha_x {r.alpha_x:.3g} at azimuth {r.direction:.0f} degrees, "
            f"alpha_y {r.alpha_y:.3g}; "
            "use both (plastic2, metal2)"
        )
    return found
