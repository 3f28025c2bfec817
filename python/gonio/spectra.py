"""Spectra of reflectance or transmittance in text files."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gonio._native import DomainError, FormatError
from gonio.text_numbers import NumberTable, clipped, finite_or_error, read_numbers

UNITS = {"nm": 1.0, "um": 1000.0}
"""Nanometres of a wavelength unit."""

_LARGEST_FRACTION = 1.5


@dataclass(frozen=True, eq=False)
class Spectra:
    """Spectra over common wavelengths.

    `wavelength` (n,) in nm, ascending; `values` (n, columns) as fractions; `names` of the columns.
    """

    wavelength: NDArray[np.float64]
    values: NDArray[np.float64]
    names: list[str]


def read_spectra(
    path: str | os.PathLike[str],
    *,
    columns: Sequence[str] = (),
    percent: bool | None = None,
    wavelength_unit: str | None = None,
) -> Spectra:
    """Read a text file whose first column is the wavelength and whose others are spectra.

    Parameters
    ----------
    path
        The file, in any of the spellings of `gonio.text_numbers.read_numbers`.
    columns
        Names, or numbers counted from 1 (the wavelength is 1), of the columns to take; all without any.
    percent
        Whether the values are percent. None: percent where the column's name holds `%`, fractions otherwise,
        and an error where values above 1.5 say that this cannot be.
    wavelength_unit
        `nm` or `um`. None: as the header says, nm otherwise, and an error where that cannot be.

    Raises
    ------
    FormatError
        The file is no such table, its wavelengths are repeated or not in nm or µm, or a value is not finite.
    DomainError
        A column that is not there, an unknown unit.
    """
    table = read_numbers(path)
    if table.values.shape[1] < 2:
        raise FormatError(f"{table.path}: found one column, allowed the wavelength and at least one spectrum")
    finite_or_error(table, what="number")
    names = table.names or ["", *(f"column {k}" for k in range(2, table.values.shape[1] + 1))]
    taken = [_column(table, names, c) for c in columns] or list(range(1, len(names)))
    wavelength = table.values[:, 0] * UNITS[_unit(table, names[0], wavelength_unit)]
    _check_wavelengths(table, wavelength)
    values = np.stack([_fractions(table, names[k], k, percent) for k in taken], axis=1)
    order = np.argsort(wavelength)
    return Spectra(wavelength[order], values[order], [names[k] for k in taken])


def _column(table: NumberTable, names: list[str], wanted: str) -> int:
    if wanted in names[1:]:
        return names.index(wanted, 1)
    if wanted.isdecimal() and 2 <= int(wanted) <= len(names):
        return int(wanted) - 1
    raise DomainError(
        f"{table.path}: column: found {clipped(wanted)}, allowed {', '.join(names[1:])} or 2 to {len(names)}"
    )


def _unit(table: NumberTable, name: str, stated: str | None) -> str:
    if stated is not None:
        if stated not in UNITS:
            raise DomainError(f"wavelength_unit: found {stated!r}, allowed {', '.join(UNITS)}")
        return stated
    head = " ".join([name, *(n for n in table.notes if "wavelength" in n.lower())]).lower()
    if re.search(r"\bmicrons?\b|\bmicromet|\bum\b|µm|μm", head):
        return "um"
    if table.values[:, 0].max() < 100.0:
        raise FormatError(
            f"{table.path}: found wavelengths {table.values[:, 0].min():g} to {table.values[:, 0].max():g} "
            "without a "
            "unit, which cannot be nm: state wavelength_unit (--wavelength-unit um)"
        )
    return "nm"


def _check_wavelengths(table: NumberTable, wavelength: NDArray[np.float64]) -> None:
    if (wavelength < 10.0).any() or (wavelength > 1e6).any():
        raise FormatError(
            f"{table.path}: found wavelengths {wavelength.min():g} to {wavelength.max():g} nm, allowed 10 to "
            "1e6 nm"
        )
    unique, counts = np.unique(wavelength, return_counts=True)
    if (counts > 1).any():
        raise FormatError(
            f"{table.path}: found wavelength {unique[counts > 1][0]:g} nm more than once, allowed each once"
        )


def _fractions(table: NumberTable, name: str, k: int, percent: bool | None) -> NDArray[np.float64]:
    values = table.values[:, k]
    if percent or (percent is None and "%" in name):
        return values / 100.0
    if percent is None and values.max() > _LARGEST_FRACTION:
        raise FormatError(
            f"{table.path}: {name}: found values up to {values.max():g}, allowed fractions up to "
            f"{_LARGEST_FRACTION:g}; state whether they are percent (percent=True, --percent; or "
            "--no-percent)"
        )
    return values
