"""Tables beside an instrument file: text of numbers, separated by commas or blanks, after `#` comments."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

from gonio.instrument_keys import Refuse


def _rows(path: Path, columns: int, *, key: str, refuse: Refuse) -> list[list[float]]:
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise refuse(key, f"{path}: {error.strerror}", "a readable file beside the instrument") from None
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        try:
            row = [float(w) for w in words]
        except ValueError:
            row = []
        if len(row) != columns or not all(map(math.isfinite, row)):
            raise refuse(key, f"{path}, line {number}: {line.strip()!r}", f"{columns} numbers")
        rows.append(row)
    if len(rows) < 2:
        raise refuse(key, f"{path}: {len(rows)} rows", "at least 2")
    return rows


def pair_rows(path: Path, *, key: str, refuse: Refuse) -> list[tuple[float, float]]:
    """Return rows of two numbers whose first increases; `key` and `refuse` make the error."""
    rows = [(a, b) for a, b in _rows(path, 2, key=key, refuse=refuse)]
    for (before, _), (after, value) in pairwise(rows):
        if after <= before or value < 0.0:
            raise refuse(key, f"{path}: {after:g} {value:g} after {before:g}", "increasing, values >= 0")
    return rows


def incidence_rows(
    path: Path, *, key: str, refuse: Refuse
) -> list[tuple[tuple[float, float], list[tuple[float, float]]]]:
    """Return directions an incidence, from rows theta_i phi_i theta_s phi_s in degrees, in their order."""
    found: dict[tuple[float, float], list[tuple[float, float]]] = {}
    for theta_i, phi_i, theta_s, phi_s in _rows(path, 4, key=key, refuse=refuse):
        if not (0.0 <= theta_i <= 180.0 and 0.0 <= theta_s <= 180.0):
            raise refuse(key, f"{path}: theta {theta_i:g}, {theta_s:g}", "0 to 180")
        found.setdefault((theta_i, phi_i), []).append((theta_s, phi_s))
    return list(found.items())
