"""Pictures as arrays and files: Radiance, OpenEXR, false colours, tone-mapped."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gonio import _native
from gonio._native import DomainError, Samples
from gonio.files import check_file, replacing_file
from gonio.radiance_colour import rgb_to_srgb
from gonio.readings import PathLike

PICTURE_SUFFIXES = (".exr", ".hdr", ".png")
_DECADES = 3.0
"""Most decades that a false-colour scale spans."""


@dataclass(frozen=True)
class Picture:
    """A rendered picture, rows from the top.

    `radiance` is red, green and blue in W/(m2 sr), shape (height, width, 3); `luminance` and its
    `standard_error` are cd/m2; `samples` the paths a pixel; `view` Radiance's view options.
    """

    radiance: NDArray[np.float64]
    luminance: NDArray[np.float64]
    standard_error: NDArray[np.float64]
    samples: NDArray[np.uint32]
    view: str


def write_picture(
    path: Path, picture: Picture, samples: Samples, *, colours: tuple[float, float] | None = None
) -> None:
    """Write a picture by the ending of `path`: .exr, .hdr, or .png in false colours between `colours`."""
    if path.suffix == ".png":
        low, high = colours or (None, None)
        false_colour(picture.luminance, out=path, low=low, high=high)
        return
    _native.write_picture(
        path,
        samples=samples,
        width=picture.luminance.shape[1],
        view=picture.view,
        software=f"gonio {_native.__version__}",
    )


def false_colour(
    luminance: NDArray[np.float64], *, out: PathLike, low: float | None = None, high: float | None = None
) -> None:
    """Draw luminance in false colours with a legend in cd/m2, on a logarithmic scale.

    Parameters
    ----------
    luminance
        cd/m2, shape (height, width), rows from the top.
    out
        The file, .png.
    low, high
        Ends of the scale in cd/m2; what is beyond takes the colour of the end. Without them the 1 % and
        99.9 % quantiles of what is not black, three decades apart at most.

    Raises
    ------
    DomainError
        Ends that are no scale, or another ending of the file.
    OSError
        The operating system refuses; nothing is left behind.
    """
    from matplotlib.colors import LogNorm  # noqa: PLC0415  (half a second that other verbs do not need)
    from matplotlib.figure import Figure  # noqa: PLC0415

    target = check_file(out)
    if target.suffix != ".png":
        raise DomainError(f"out: found the ending {target.suffix!r}, allowed .png")
    lit = luminance[luminance > 0.0]
    ends = np.quantile(lit, (0.01, 0.999)) if lit.size else np.array([0.1, 1.0])
    high = float(ends[1]) if high is None else high
    low = max(float(ends[0]), high * 10.0**-_DECADES) if low is None else low
    if low == high:
        low, high = 0.5 * low, 2.0 * high
    if not 0.0 < low < high < np.inf:
        raise DomainError(f"low, high: found {low:g}, {high:g}, allowed 0 < low < high")
    height, width = luminance.shape
    figure = Figure(figsize=(7.2, 6.0 * height / width + 0.4), layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(
        np.clip(luminance, low, high), norm=LogNorm(low, high), cmap="turbo", interpolation="nearest"
    )
    axes.set_axis_off()
    bar = figure.colorbar(image, ax=axes, extend="both")
    bar.set_label("luminance / cd m⁻²")
    with replacing_file(target) as staged:
        figure.savefig(staged, format="png", dpi=150)


def tone_mapped(picture: Picture, *, out: PathLike) -> None:
    """Write a picture for the eye, in sRGB.

    The exposure puts the geometric mean of the luminance at 0.18. Reinhard's curve x (1 + x / w²) / (1 + x)
    [Reinhard2002, eq. 4], with the 99.9 % quantile of the luminance at w, keeps bright parts from burning
    out; colours keep their ratio.

    Raises
    ------
    DomainError
        Another ending than .png.
    OSError
        The operating system refuses; nothing is left behind.
    """
    from matplotlib.image import imsave  # noqa: PLC0415  (half a second that other verbs do not need)

    target = check_file(out)
    if target.suffix != ".png":
        raise DomainError(f"out: found the ending {target.suffix!r}, allowed .png")
    luminance = picture.luminance
    lit = luminance[luminance > 0.0]
    if not lit.size:
        lit = np.ones(1)
    key = 0.18 / np.exp(np.log(lit).mean())
    x = key * luminance
    white = max(key * float(np.quantile(lit, 0.999)), 1.0)
    mapped = x * (1.0 + x / white**2) / (1.0 + x)
    scale = mapped / np.where(luminance > 0.0, luminance, 1.0)
    # White of radiance 1 has 179 cd/m2.
    linear = np.clip(rgb_to_srgb(picture.radiance * 179.0 * scale[..., None]), 0.0, 1.0)
    coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    with replacing_file(target) as staged:
        imsave(staged, (255.0 * coded + 0.5).astype(np.uint8), format="png")
