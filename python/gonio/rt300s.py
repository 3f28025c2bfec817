"""Readings of a J&C RT-300S: the .xls workbooks its software exports (docs/formats/rt300s.md)."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from python_calamine import CalamineError, CalamineWorkbook

from gonio._native import FormatError, QuantityError, Scan

FORMAT = "rt300s"
MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"  # OLE2, the container of .xls

# Row of the sheets for each quantity, and the factor that turns it into that quantity. RT is the reading
# against a white diffuser: it goes with the detector signal by one factor at all angles, and it is
# reciprocal once divided by cos theta_s, so RT / pi is the DSF and not the BSDF (docs/formats/rt300s.md).
ROWS = {"dsf": ("RT", 1.0 / math.pi), "signal": ("RT/nm", 1.0)}
METHOD = "BRDF_LD"
LASER = "650nm"  # the laser diode of METHOD

Array = npt.NDArray[Any]


def read(
    path: str | os.PathLike[str],
    *,
    kind: str | None = None,
    quantity: str | None = None,
    channel: str | None = None,
) -> list[Scan]:
    """Scans of a workbook, one an incidence, readings in the order of the sheets.

    Parameters
    ----------
    path
        The workbook.
    kind
        `sample` unless given; `dark` for a blank run, `standard` for a run on a standard.
    quantity
        `dsf` (row RT over pi) unless given; `signal` takes row RT/nm, the detector's reading.
    channel
        650nm unless given: the file names its method, BRDF_LD (laser diode), and no wavelength.

    Raises
    ------
    FormatError
        The file is no such workbook; names sheet, row and cell.
    QuantityError
        A quantity the workbook does not hold.
    OSError
        The operating system refuses.
    """
    if quantity is not None and quantity not in ROWS:
        raise QuantityError(f"quantity: found {quantity}, needed one of {', '.join(ROWS)}")
    quantity = quantity or "dsf"
    row, factor = ROWS[quantity]
    rows = _rows(Path(path), ("Method", "Azimuth", "Incidence", "Receive", "Date", "Time", row))
    methods = sorted({str(m) for m in np.unique(rows["Method"].astype(str))})
    if methods != [METHOD] and channel is None:
        raise FormatError(
            f"{path}: Method: found {', '.join(methods)}, allowed {METHOD}, or state the channel"
        )
    azimuth, incidence, receive = (
        _numbers(path, name, rows[name], limit)
        for name, limit in (("Azimuth", 360.0), ("Incidence", 90.0), ("Receive", 180.0))
    )
    value = factor * _numbers(path, row, rows[row], np.inf, blank_is_nan=True)
    moment = _moments(path, rows["Date"], rows["Time"])
    # In-plane readings stand at azimuth -90 and 90, so phi = azimuth + 90; with the source at phi_i = 180 the
    # mirror direction is at azimuth -90 and positive receive angles, where the readings peak.
    theta_s = np.abs(receive)
    phi_s = (azimuth + 90.0 + np.where(receive < 0.0, 180.0, 0.0)) % 360.0
    scans = []
    angles, first = np.unique(incidence, return_index=True)
    for k in np.argsort(first):
        here = incidence == angles[k]
        meta = {"instrument": "J&C RT-300S", "source": os.fspath(path), "other": {"method": methods[0]}}
        time = None
        if moment is not None:
            time = (moment[here] - moment[here][0]) / np.timedelta64(1, "s")
            meta["started"] = str(moment[here][0])
        scans.append(
            Scan(
                kind=kind or "sample",
                quantity=quantity,
                channel=channel or LASER,
                theta_i=float(abs(angles[k])),
                phi_i=180.0 if angles[k] >= 0.0 else 0.0,
                theta_s=theta_s[here],
                phi_s=phi_s[here],
                value=value[here],
                time=time,
                meta=meta,
            )
        )
    return scans


def _rows(path: Path, names: tuple[str, ...]) -> dict[str, Array]:
    """Cells of the rows `names`, joined over the sheets; the first column of every sheet holds the names."""
    with path.open("rb") as handle:  # a missing file, a directory or a lack of permission is named here
        start = handle.read(len(MAGIC))
        if start != MAGIC:
            found = "0 bytes" if not start else repr(start)
            raise FormatError(f"{path}: file: found {found}, allowed an .xls workbook of the RT-300S")
        handle.seek(0)
        try:
            book = CalamineWorkbook.from_filelike(handle)
            sheets = {name: book.get_sheet_by_name(name).to_python() for name in book.sheet_names}
        except (CalamineError, OSError) as error:
            raise FormatError(
                f"{path}: workbook: found damage ({error}), allowed a whole .xls file"
            ) from error
    parts: dict[str, list[Array]] = {name: [] for name in names}
    for sheet, cells in sheets.items():
        if not cells:
            continue
        table = np.empty((len(cells), len(cells[0])), dtype=object)
        table[:] = cells
        labels = [str(label).strip() for label in table[:, 0]]
        missing = [name for name in names if name not in labels]
        if missing:
            raise FormatError(
                f"{path}, sheet {sheet}: rows: found no {', '.join(missing)}, allowed a sheet with "
                f"{', '.join(names)} in its first column"
            )
        for name in names:
            parts[name].append(table[labels.index(name), 1:])
    joined = {name: np.concatenate(p) if p else np.empty(0, object) for name, p in parts.items()}
    filled = joined["Receive"] != ""
    if not filled.any():
        raise FormatError(f"{path}: readings: found none, allowed at least one column of readings")
    return {name: cells[filled] for name, cells in joined.items()}


def _numbers(
    path: str | os.PathLike[str], name: str, cells: Array, limit: float, *, blank_is_nan: bool = False
) -> Array:
    """Cells as float64, at most `limit` in size."""
    if blank_is_nan:
        cells = np.where(cells == "", np.nan, cells)
    try:
        numbers = cells.astype(np.float64)
    except (TypeError, ValueError) as error:
        raise FormatError(
            f"{path}: {name}: found a cell that is no number ({error}), allowed numbers"
        ) from error
    bad = np.isinf(numbers) | (np.abs(numbers) > limit) | (np.isnan(numbers) & (not blank_is_nan))
    if bad.any():
        reading = int(np.argmax(bad))
        raise FormatError(
            f"{path}: {name} of reading {reading + 1}: found {numbers[reading]}, allowed -{limit} to {limit}"
        )
    return numbers


def _moments(path: str | os.PathLike[str], dates: Array, times: Array) -> Array | None:
    """Date and time of each reading; None where the workbook leaves them out."""
    if (dates == "").any() or (times == "").any():
        return None
    try:
        text = np.char.add(np.char.add(dates.astype(str), "T"), times.astype(str))
        return text.astype("datetime64[s]")
    except ValueError as error:
        raise FormatError(f"{path}: Date, Time: found {error}, allowed dates and times of day") from error
