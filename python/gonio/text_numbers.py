"""Tables of numbers in text files of any of the usual spellings: spectra, surface profiles, height maps."""

from __future__ import annotations

import codecs
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gonio._native import FormatError

_COMMENTS = ("#", "%", "!", "//", "{")
_HEADER_LINES = 200
_CLIP = 40
_LONGEST_LINE = 10_000_000


@dataclass(frozen=True, eq=False)
class NumberTable:
    """Numbers of a text file.

    `values` has the shape (rows, columns). `names` are the column names of the line before the numbers, None
    without such a line (or where it has another number of fields). `notes` are the other lines before the
    numbers, without their comment mark. `first_line` is the line of the first row, counted from 1.
    """

    path: str
    values: NDArray[np.float64]
    names: list[str] | None
    notes: list[str]
    first_line: int


def read_numbers(path: str | os.PathLike[str]) -> NumberTable:
    """Read a rectangular table of numbers.

    Columns are separated by tabs, semicolons, commas or blanks, told from the first row of numbers. Decimal
    commas are understood where the separator is not a comma. Empty lines and lines that start with `#`, `%`,
    `!`, `//` or `{` are skipped. `nan` is a number here: the caller decides whether it is allowed.

    Raises
    ------
    FormatError
        No text, no numbers, rows of different length, or something else than a number, with its line.
    OSError
        The file cannot be read.
    """
    file = os.fspath(path)
    lines = _text(file, Path(path).read_bytes()).splitlines()
    first, head = _first_row(file, lines)
    separator, decimal_comma = _spelling(lines[first])
    body = [line.replace(",", ".") for line in lines[first:]] if decimal_comma else lines[first:]
    try:
        values = np.loadtxt(body, delimiter=separator, comments=list(_COMMENTS), ndmin=2)
    except ValueError:
        values = _row_by_row(file, body, separator, first)
    names, notes = _head(head, separator, values.shape[1])
    return NumberTable(path=file, values=values, names=names, notes=notes, first_line=first + 1)


def clipped(text: str) -> str:
    """`text` in quotes, cut to what fits an error message."""
    return repr(text if len(text) <= _CLIP else text[:_CLIP] + "…")


def _text(file: str, data: bytes) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            raise FormatError(f"{file}: found broken UTF-16, allowed text") from None
    if b"\0" in data[: 1 << 16]:
        raise FormatError(f"{file}: found binary data, allowed text")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Instruments write the micro sign in this one; it maps every byte.
        return data.decode("latin-1")


def _first_row(file: str, lines: list[str]) -> tuple[int, list[str]]:
    """Index of the first row of numbers and the lines before it that are not empty."""
    head: list[str] = []
    for k, line in enumerate(lines):
        if len(line) > _LONGEST_LINE:
            raise FormatError(
                f"{file}, line {k + 1}: found {len(line)} characters, allowed {_LONGEST_LINE} in a line"
            )
    for k, line in enumerate(lines[:_HEADER_LINES]):
        text = line.strip()
        if not text:
            continue
        if not text.startswith(_COMMENTS) and _spelling(line) != (None, None):
            return k, head
        head.append(text)
    if not head:
        raise FormatError(f"{file}: found no data, allowed rows of numbers")
    where = "the file" if len(lines) <= _HEADER_LINES else f"the first {_HEADER_LINES} lines"
    raise FormatError(
        f"{file}, line 1: found {clipped(head[0])} and no row of numbers in {where}, "
        "allowed columns of numbers after a header"
    )


def _spelling(line: str) -> tuple[str | None, bool | None]:
    """Separator (None: blanks) and whether commas are decimal; (None, None) for a line that is no numbers."""
    for separator in ("\t", ";", ",", None):
        if separator is not None and separator not in line:
            continue
        fields = _fields(line, separator)
        if not fields:
            continue
        if all(_is_number(f) for f in fields):
            return separator, False
        if separator != "," and all(_is_number(f.replace(",", ".")) and f.count(",") <= 1 for f in fields):
            return separator, True
    return None, None


def _fields(line: str, separator: str | None) -> list[str]:
    fields = [f.strip() for f in line.split(separator)]
    # A separator at the end of the line ends the last column and begins none.
    return fields[:-1] if len(fields) > 1 and not fields[-1] else fields


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text


def _row_by_row(file: str, lines: list[str], separator: str | None, first: int) -> NDArray[np.float64]:
    """The rows, or an error that names the first line that is none."""
    rows: list[list[float]] = []
    for k, line in enumerate(lines):
        text = line.strip()
        if not text or text.startswith(_COMMENTS):
            continue
        fields = _fields(line, separator)
        where = f"{file}, line {first + k + 1}"
        for field in fields:
            if not _is_number(field):
                raise FormatError(f"{where}: found {clipped(field)}, allowed a number")
        if rows and len(fields) != len(rows[0]):
            raise FormatError(f"{where}: found {len(fields)} columns, allowed {len(rows[0])} as before")
        rows.append([float(f) for f in fields])
    return np.array(rows, dtype=np.float64)


def _head(head: list[str], separator: str | None, columns: int) -> tuple[list[str] | None, list[str]]:
    """Column names, when the last line before the numbers has as many fields, and the other lines."""
    plain = [re.sub(r"^(#+|%+|!+|//+)\s*", "", line) for line in head]
    if not plain:
        return None, []
    for mark in (separator, ",", ";", "\t"):
        fields = [f.strip().strip('"') for f in plain[-1].split(mark)]
        if len(fields) == columns and not all(_is_number(f) for f in fields):
            return fields, plain[:-1]
    return None, plain


def finite_or_error(table: NumberTable, *, what: str, allow_nan: bool = False) -> None:
    """Raise FormatError with the line of the first value that is infinite (or NaN, unless allowed)."""
    bad = np.isinf(table.values) if allow_nan else ~np.isfinite(table.values)
    if bad.any():
        row, column = (int(k) for k in np.argwhere(bad)[0])
        found = table.values[row, column]
        name = table.names[column] if table.names else f"column {column + 1}"
        text = "nan" if math.isnan(found) else f"{found:g}"
        raise FormatError(
            f"{table.path}, row {row + 1} of the numbers: {name}: found {text}, allowed a finite {what}"
        )
