"""Spectra and channels to CIE XYZ and to Radiance's RGB."""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gonio._native import DomainError, FormatError
from gonio.radiance_colour import luminance, rgb_of_srgb, rgb_of_xyz
from gonio.spectra import read_spectra

ILLUMINANTS = ("D65", "A", "E")
"""Light under which a spectrum is seen."""

RADIANCE_PRIMARIES, SRGB = "Radiance", "sRGB"

PRIMARIES = (RADIANCE_PRIMARIES, SRGB)
"""What channels red, green and blue may be: in Radiance's primaries, or linear sRGB."""

_FIRST, _LAST = 360, 780
_LARGEST_GAP = 20.0
_LARGEST_MISSING = 0.02
_TELL_MISSING = 0.001
_PHOTOPIC_DIFFERENCE = 0.02


@dataclass(frozen=True)
class Colour:
    """Colour of a reflectance or transmittance.

    Attributes
    ----------
    name
        Of the column or the set of channels.
    photopic
        V(λ)-weighted value under `illuminant`; None where only RGB channels were given.
    xyz
        CIE 1931 tristimulus values under `illuminant`, Y of white 1; None as above.
    rgb
        In Radiance's primaries, nothing below 0.
    rgb_unclipped
        The same with the negative values of colours outside the gamut.
    luminance
        Of `rgb`, in Radiance's weights.
    illuminant
        Light under which `xyz` is; the RGB is adapted from it to equal energy.
    source
        What it was made from: `spectrum`, `rgb` or `photopic`.
    """

    name: str
    photopic: float | None
    xyz: tuple[float, float, float] | None
    rgb: tuple[float, float, float]
    rgb_unclipped: tuple[float, float, float]
    luminance: float
    illuminant: str | None
    source: str
    warnings: list[str] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as `gonio colour --json` prints them."""
        return asdict(self)


def colour(
    path: str | os.PathLike[str],
    *,
    columns: Sequence[str] = (),
    illuminant: str = "D65",
    percent: bool | None = None,
    wavelength_unit: str | None = None,
) -> list[Colour]:
    """Colours of the spectra of a text file, one a column.

    Parameters
    ----------
    path, columns, percent, wavelength_unit
        As in `gonio.spectra.read_spectra`.
    illuminant
        D65, A or E.

    Raises
    ------
    FormatError, OSError
        As `read_spectra`; or the wavelengths leave out more than 2 % of a weighting, or leave a gap above 20
        nm.
    DomainError
        As `read_spectra`; an unknown illuminant.
    """
    spectra = read_spectra(path, columns=columns, percent=percent, wavelength_unit=wavelength_unit)
    try:
        return colours_of_spectra(
            spectra.wavelength, spectra.values, names=spectra.names, illuminant=illuminant
        )
    except FormatError as error:
        raise FormatError(f"{os.fspath(path)}: {error}") from None


def colour_of_channels(
    values: Mapping[str, float], *, illuminant: str = "D65", primaries: str = RADIANCE_PRIMARIES
) -> Colour:
    """Colour of one number for each channel: of a fit, a measurement, a set of dhr.

    What the channels are decides, in this order:

    - `red`, `green`, `blue`: they are the RGB, as they are; with the `primaries` "sRGB" they are linear sRGB
      and become Radiance's (`gonio.radiance_colour.rgb_of_srgb`);
    - wavelengths such as `550nm`: a spectrum, as in `colours_of_spectra`;
    - `photopic` alone: grey, all three the photopic value.

    Raises
    ------
    DomainError
        None of these, two of `red`, `green`, `blue`, a value that is not finite, other `primaries`.
    FormatError
        The wavelengths do not span the visible.
    """
    _check_illuminant(illuminant)
    if primaries not in PRIMARIES:
        raise DomainError(f"primaries: found {primaries!r}, allowed {', '.join(PRIMARIES)}")
    for name, value in values.items():
        if not np.isfinite(value):
            raise DomainError(f"channel {name}: found {value:g}, allowed a finite number")
    rgb_names = [n for n in ("red", "green", "blue") if n in values]
    photopic = values.get("photopic")
    if len(rgb_names) == 3:
        rgb = np.array([values[n] for n in rgb_names], dtype=np.float64)
        if primaries == SRGB:
            rgb = rgb_of_srgb(rgb)
        return _colour("channels", rgb, photopic=photopic, source="rgb")
    if rgb_names:
        raise DomainError(f"channels: found {', '.join(rgb_names)}, allowed red, green and blue together")
    wavelengths = {float(m[1]): v for n, v in values.items() if (m := re.fullmatch(r"([\d.]+)\s*nm", n))}
    if len(wavelengths) > 1:
        order = sorted(wavelengths)
        column = np.array([[wavelengths[w]] for w in order], dtype=np.float64)
        return colours_of_spectra(order, column, names=["channels"], illuminant=illuminant)[0]
    if photopic is not None:
        return _colour("channels", np.full(3, float(photopic)), photopic=photopic, source="photopic")
    raise DomainError(
        f"channels: found {', '.join(values) or 'none'}, allowed red, green and blue, photopic, or "
        "wavelengths that "
        "span the visible"
    )


def colours_of_spectra(
    wavelength: Sequence[float] | NDArray[np.float64],
    values: NDArray[np.float64],
    *,
    names: Sequence[str],
    illuminant: str = "D65",
) -> list[Colour]:
    """Colours of spectra given as arrays.

    The spectra are interpolated to 1 nm by monotone cubics, which do not overshoot [FritschButland1984], kept
    constant beyond their ends, and summed with the CIE 1931 2° observer and the illuminant's power from 360
    to 780 nm [CIE15, section 7.1].

    Parameters
    ----------
    wavelength
        (n,) in nm, ascending.
    values
        (n, columns), fractions. Nothing is clipped.
    names
        Of the columns.
    illuminant
        D65, A or E.

    Raises
    ------
    FormatError
        Fewer than two wavelengths; a gap above 20 nm in the visible; ends that leave out more than 2 % of the
        weight of X, Y or Z.
    DomainError
        An unknown illuminant.
    """
    # Imported here: scipy takes longer to load than all the rest of the command line.
    from scipy.interpolate import PchipInterpolator  # noqa: PLC0415

    _check_illuminant(illuminant)
    at = np.asarray(wavelength, dtype=np.float64)
    table = np.asarray(values, dtype=np.float64)
    if table.ndim != 2 or len(at) != len(table) or len(names) != table.shape[1]:
        raise DomainError(
            f"values: found the shape {table.shape}, allowed ({len(at)}, {len(names)}): wavelengths by names"
        )
    weights, white = _weights(illuminant)
    grid = np.arange(_FIRST, _LAST + 1, dtype=np.float64)
    missing = _missing(at, weights, grid)
    spectra = PchipInterpolator(at, table, axis=0)(np.clip(grid, at[0], at[-1]))
    result = []
    for name, spectrum, xyz in zip(names, spectra.T, (weights @ spectra).T, strict=True):
        rgb = rgb_of_xyz(xyz, white=white)
        found = _colour(name, rgb, photopic=float(xyz[1]), source="spectrum", xyz=xyz, illuminant=illuminant)
        if missing > _TELL_MISSING:
            found.warnings.append(
                f"{name}: the wavelengths {at[0]:g} to {at[-1]:g} nm leave out {100 * missing:.2g} % of a "
                "weighting; "
                "the spectrum was continued with its end values"
            )
        if spectrum.min() < 0.0 or spectrum.max() > 1.0:
            found.warnings.append(
                f"{name}: values from {spectrum.min():.4g} to {spectrum.max():.4g} in the visible, "
                "0 to 1 is possible without fluorescence"
            )
        result.append(found)
    return result


def _check_illuminant(illuminant: str) -> None:
    if illuminant not in ILLUMINANTS:
        raise DomainError(f"illuminant: found {illuminant!r}, allowed {', '.join(ILLUMINANTS)}")


@functools.cache
def _weights(illuminant: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weights (3, 421) of the reflectance at 360 to 780 nm in X, Y, Z, and XYZ of the white.

    The tables are colour-science's [Mansencal2025]; illuminants of 5 nm are interpolated linearly, as CIE 15
    asks for D65. Its import takes seconds, so it waits until a spectrum comes.
    """
    import colour as colour_science  # noqa: PLC0415

    grid = np.arange(_FIRST, _LAST + 1, dtype=np.float64)
    observer = colour_science.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    light = colour_science.SDS_ILLUMINANTS[illuminant]
    power = np.interp(grid, light.wavelengths, light.values)
    bars = np.stack([np.interp(grid, observer.wavelengths, observer.values[:, k]) for k in range(3)])
    weights = bars * power
    weights /= weights[1].sum()
    return weights, weights.sum(axis=1)


def _missing(at: NDArray[np.float64], weights: NDArray[np.float64], grid: NDArray[np.float64]) -> float:
    """Largest share of a weighting outside the wavelengths `at`; an error when it is too large."""
    if len(at) < 2:
        raise FormatError(f"found {len(at)} wavelength, allowed at least 2")
    outside = (grid < at[0]) | (grid > at[-1])
    share = float((weights[:, outside].sum(axis=1) / weights.sum(axis=1)).max())
    if share > _LARGEST_MISSING:
        raise FormatError(
            f"found wavelengths {at[0]:g} to {at[-1]:g} nm, which leave out {100 * share:.3g} % of a "
            "weighting, "
            f"allowed {100 * _LARGEST_MISSING:g} %: 410 to 690 nm or more"
        )
    step = np.diff(at)
    wide = np.flatnonzero((step > _LARGEST_GAP * (1 + 1e-9)) & (at[1:] > 380.0) & (at[:-1] < 730.0))
    if len(wide):
        k = int(wide[0])
        raise FormatError(
            f"found a gap from {at[k]:g} to {at[k + 1]:g} nm, allowed steps up to {_LARGEST_GAP:g} nm in the "
            "visible"
        )
    return share


def _colour(
    name: str,
    rgb: NDArray[np.float64],
    *,
    photopic: float | None,
    source: str,
    xyz: NDArray[np.float64] | None = None,
    illuminant: str | None = None,
) -> Colour:
    clipped = np.maximum(rgb, 0.0)
    found = Colour(
        name=name,
        photopic=photopic,
        xyz=None if xyz is None else _three(xyz),
        rgb=_three(clipped),
        rgb_unclipped=_three(rgb),
        luminance=luminance(clipped),
        illuminant=illuminant,
        source=source,
    )
    if (rgb < 0.0).any():
        red, green, blue = rgb
        found.warnings.append(
            f"{name}: outside the gamut of Radiance's primaries ({red:.4f} {green:.4f} {blue:.4f}); negative "
            "values "
            "are set to 0"
        )
    if photopic and abs(found.luminance - photopic) > _PHOTOPIC_DIFFERENCE * abs(photopic):
        found.warnings.append(
            f"{name}: the RGB's luminance {found.luminance:.4f} differs from the photopic value "
            f"{photopic:.4f}; "
            "where illuminances matter, scale the RGB by their ratio"
        )
    return found


def _three(values: NDArray[np.float64]) -> tuple[float, float, float]:
    a, b, c = (float(v) for v in values)
    return a, b, c
