"""Surface profiles and height maps in files."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gonio._native import DomainError, FormatError
from gonio.text_numbers import NumberTable, clipped, finite_or_error, read_numbers

UNITS = {"m": 1e6, "mm": 1e3, "um": 1.0, "nm": 1e-3}
"""Micrometres of a length unit."""

LEAST_PROFILE = 50
LEAST_SIDE = 16

_EVEN = 1e-3
_UNIT = re.compile(
    r"(?:\[|\(|/|\bin\b|:|,|_|\s)\s*(m|mm|um|µm|μm|nm|micromet(?:re|er)s?|microns?)\s*(?:\]|\)|$)"
)


@dataclass(frozen=True, eq=False)
class Surface:
    """Heights over equal steps, in micrometres.

    `z` is a profile (n,) along x or a map (rows, columns): x grows with the column, y with the row. NaN is a
    point that was not measured. `dx`, `dy` are the steps; `dy` of a profile is None.
    """

    z: NDArray[np.float64]
    dx: float
    dy: float | None = None
    path: str | None = None

    @property
    def is_map(self) -> bool:
        """Whether this is a height map."""
        return self.z.ndim == 2


def read_surface(
    path: str | os.PathLike[str],
    *,
    spacing: float | tuple[float, float] | None = None,
    x_unit: str | None = None,
    z_unit: str | None = None,
) -> Surface:
    """Read a surface: `.sdf` (ISO 25178-71), `.npy`, or text.

    A text file of one column holds heights, of two columns x and z, of 16 or more columns the rows of a
    height map. Units are taken from the column names (`z [nm]`) or from the header lines `Width`, `Height`
    and `Value units` of a Gwyddion text export; nothing is assumed where the file is silent. An SDF states
    metres.

    Parameters
    ----------
    path
        The file; its suffix tells the format.
    spacing
        Step between points in `x_unit`, or the steps (dx, dy): of files that do not hold it.
    x_unit, z_unit
        m, mm, um or nm: of files that do not state them. What the file states counts.

    Raises
    ------
    FormatError
        Not such a file, too few points, uneven steps, a unit or step that nothing states.
    DomainError
        An unknown unit, a step that is not positive.
    OSError
        The file cannot be read.
    """
    for name, unit in (("x_unit", x_unit), ("z_unit", z_unit)):
        if unit is not None and unit not in UNITS:
            raise DomainError(f"{name}: found {unit!r}, allowed {', '.join(UNITS)}")
    steps = two_steps(spacing)
    file = os.fspath(path)
    suffix = Path(path).suffix.lower()
    if suffix == ".sdf":
        surface = _read_sdf(file)
    elif suffix == ".npy":
        z = _read_npy(file) * _factor(file, "z_unit", None, z_unit)
        surface = _with_steps(file, z, steps, _factor(file, "x_unit", None, x_unit))
    else:
        surface = _read_text(file, steps, x_unit, z_unit)
    check_surface(surface)
    return surface


def check_surface(surface: Surface) -> None:
    """Raise FormatError unless there are enough points, half of them measured, at more than one height."""
    name = surface.path or "surface"
    if surface.is_map:
        rows, columns = surface.z.shape
        if min(rows, columns) < LEAST_SIDE:
            raise FormatError(
                f"{name}: found a height map of {rows} x {columns} points, allowed {LEAST_SIDE} or more a "
                "side"
            )
    elif surface.z.size < LEAST_PROFILE:
        raise FormatError(
            f"{name}: found a profile of {surface.z.size} points, allowed {LEAST_PROFILE} or more"
        )
    finite = np.isfinite(surface.z)
    if finite.mean() < 0.5:
        raise FormatError(
            f"{name}: found {100 * finite.mean():.0f} % of the points measured, allowed half or more"
        )
    if np.ptp(surface.z[finite]) == 0.0:
        raise FormatError(f"{name}: found one height at all points, allowed a surface with texture")


def two_steps(spacing: float | tuple[float, float] | None) -> tuple[float, float] | None:
    """Steps (dx, dy) of `spacing`: one number is both; DomainError unless they are above 0."""
    if spacing is None:
        return None
    both = (spacing, spacing) if isinstance(spacing, (int, float)) else tuple(spacing)
    if len(both) != 2 or not all(np.isfinite(s) and s > 0.0 for s in both):
        raise DomainError(f"spacing: found {spacing}, allowed one or two numbers above 0")
    return float(both[0]), float(both[1])


def _factor(file: str, name: str, stated: str | None, given: str | None) -> float:
    """Micrometres of the unit that the file states, or else of the one given."""
    unit = stated or given
    if unit is None:
        option = "--" + name.replace("_", "-")
        raise FormatError(f"{file}: states no {name}: give {name} ({option}), one of {', '.join(UNITS)}")
    return UNITS[unit]


def _with_steps(
    file: str, z: NDArray[np.float64], steps: tuple[float, float] | None, factor: float
) -> Surface:
    if steps is None:
        raise FormatError(f"{file}: states no step between points: give spacing (--spacing)")
    dx, dy = (s * factor for s in steps)
    return Surface(z, dx, dy if z.ndim == 2 else None, file)


def _read_sdf(file: str) -> Surface:
    import sdfio  # noqa: PLC0415

    data = Path(file).read_bytes()
    try:
        sdf = sdfio.SdfFile.loads(data)
    except (sdfio.SdfError, ValueError, OverflowError) as error:
        raise FormatError(
            f"{file}: found a fault ({clipped(' '.join(str(error).split()))}), allowed an ISO 25178-71 file"
        ) from None
    z = np.asarray(sdf.data, dtype=np.float64) * UNITS["m"]
    dx, dy = sdf.header.x_scale * UNITS["m"], sdf.header.y_scale * UNITS["m"]
    profile = z.shape[0] == 1
    if not dx > 0.0 or not (profile or dy > 0.0) or not np.isfinite([dx, dy]).all():
        raise FormatError(f"{file}: Xscale, Yscale: found {dx:g}, {dy:g} um, allowed above 0")
    return Surface(z[0], dx, None, file) if profile else Surface(z, dx, dy, file)


def _read_npy(file: str) -> NDArray[np.float64]:
    try:
        # Mapped: a header that promises more than the file holds is refused before memory is asked for.
        z = np.load(file, mmap_mode="r", allow_pickle=False)
    except OSError:
        raise
    except Exception as error:  # a damaged header ends in whatever Python's parser says of it
        raise FormatError(
            f"{file}: found a fault ({clipped(' '.join(str(error).split()))}), allowed an .npy array"
        ) from None
    if not isinstance(z, np.ndarray) or z.dtype.kind not in "fiu" or z.ndim not in (1, 2):
        found = f"{z.ndim}-dimensional {z.dtype}" if isinstance(z, np.ndarray) else type(z).__name__
        raise FormatError(f"{file}: found a {found} array, allowed real numbers in 1 or 2 dimensions")
    heights = np.array(z, dtype=np.float64)
    if np.isinf(heights).any():
        raise FormatError(
            f"{file}: found an infinite height, allowed finite heights and nan where not measured"
        )
    return heights


def _read_text(
    file: str, steps: tuple[float, float] | None, x_unit: str | None, z_unit: str | None
) -> Surface:
    table = read_numbers(file)
    finite_or_error(table, what="height, or nan where not measured", allow_nan=True)
    columns = table.values.shape[1]
    if columns == 2:
        return _profile(file, table, x_unit, z_unit)
    if 2 < columns < LEAST_SIDE:
        raise FormatError(
            f"{file}: found {columns} columns, allowed 1 (heights), 2 (x and height) or {LEAST_SIDE} and "
            "more "
            "(rows of a height map)"
        )
    if columns == 1:
        unit = _stated_unit(table.names[0] if table.names else "") or _note_unit(table, "value units")
        z = table.values[:, 0] * _factor(file, "z_unit", unit, z_unit)
        return _with_steps(file, z, steps, _factor(file, "x_unit", None, x_unit))
    z = table.values * _factor(file, "z_unit", _note_unit(table, "value units"), z_unit)
    width, height = _note_length(table, "width"), _note_length(table, "height")
    if width is not None and height is not None:
        return Surface(z, width / z.shape[1], height / z.shape[0], file)
    return _with_steps(file, z, steps, _factor(file, "x_unit", None, x_unit))


def _profile(file: str, table: NumberTable, x_unit: str | None, z_unit: str | None) -> Surface:
    names = table.names or ["", ""]
    x = table.values[:, 0] * _factor(file, "x_unit", _stated_unit(names[0]), x_unit)
    z = table.values[:, 1] * _factor(file, "z_unit", _stated_unit(names[1]), z_unit)
    if len(x) < 2:
        raise FormatError(f"{file}: found a profile of {len(x)} points, allowed {LEAST_PROFILE} or more")
    if np.isnan(x).any():
        raise FormatError(f"{file}: found nan for an x, allowed equal steps")
    step = np.diff(x)
    mean = float((x[-1] - x[0]) / (len(x) - 1))
    if mean <= 0.0 or np.abs(step - mean).max() > max(_EVEN * mean, 4 * np.spacing(np.abs(x).max())):
        k = int(np.argmax(np.abs(step - mean)))
        raise FormatError(
            f"{file}, rows {k + 1} and {k + 2} of the numbers: found a step of {step[k]:g} um where the mean "
            "is "
            f"{mean:g} um, allowed equal steps of rising x (to {100 * _EVEN:g} %)"
        )
    return Surface(z, mean, None, file)


def _stated_unit(name: str) -> str | None:
    found = _UNIT.search(name.strip())
    if found is None:
        return None
    return "um" if found[1][0] in "µμ" or found[1].startswith("micro") else found[1]


def _note(table: NumberTable, key: str) -> str | None:
    for note in table.notes:
        name, colon, value = note.partition(":")
        if colon and name.strip().lower() == key:
            return value.strip()
    return None


def _note_unit(table: NumberTable, key: str) -> str | None:
    value = _note(table, key)
    return None if value is None else _stated_unit(f"[{value}]")


def _note_length(table: NumberTable, key: str) -> float | None:
    """A length of the header in micrometres."""
    value = _note(table, key)
    found = None if value is None else re.fullmatch(r"([-+.\deE]+)\s*(\S+)", value)
    if found is None:
        return None
    unit = _stated_unit(f"[{found[2]}]")
    try:
        length = float(found[1]) * UNITS[unit] if unit else 0.0
    except ValueError:
        length = 0.0
    if not length > 0.0:
        raise FormatError(f"{table.path}: {key}: found {value}, allowed a length above 0 with its unit")
    return length
