"""The path of a virtual campaign: as a table and as a drawing."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gonio._native import DomainError, Scan
from gonio.files import replacing_file

PICTURES = (".png", ".svg", ".pdf")
"""Endings of drawings."""

SHOWN = 200_000
"""Readings drawn of one incidence at most; of more every n-th is."""


@dataclass(frozen=True)
class PathOfScan:
    """Where the detector read for one incidence: angles in degrees, seconds since the campaign began."""

    theta_i: float
    phi_i: float
    theta_s: NDArray[np.float64]
    phi_s: NDArray[np.float64]
    time: NDArray[np.float64]


def paths_of(records: Sequence[Scan]) -> tuple[PathOfScan, ...]:
    """Return the path of each sample record, once for all channels read at a time."""
    found: dict[tuple[float, float], PathOfScan] = {}
    for r in records:
        if r.kind == "sample" and (r.theta_i, r.phi_i) not in found:
            time = np.full(len(r), np.nan) if r.time is None else np.asarray(r.time)
            found[r.theta_i, r.phi_i] = PathOfScan(
                r.theta_i, r.phi_i, np.asarray(r.theta_s), np.asarray(r.phi_s), time
            )
    return tuple(found.values())


def write_path_table(path: Sequence[PathOfScan], *, out: str | os.PathLike[str]) -> None:
    """Write rows theta_i phi_i theta_s phi_s in degrees, which an instrument file takes as `path.table`.

    Raises
    ------
    OSError
        The file system refuses.
    """
    with replacing_file(Path(out)) as staged, staged.open("w", encoding="utf-8") as file:
        file.write("# theta_i phi_i theta_s phi_s, degrees\n")
        for p in path:
            fixed = np.broadcast_to([p.theta_i, p.phi_i], (len(p.theta_s), 2))
            np.savetxt(file, np.column_stack([fixed, p.theta_s, p.phi_s]), fmt="%.6g %.6g %.4f %.4f")


def plot_path(path: Sequence[PathOfScan], *, out: str | os.PathLike[str]) -> None:
    """Draw the path of each incidence over the hemispheres it reads, polar angle outwards.

    Raises
    ------
    DomainError
        The file's ending is none of .png, .svg, .pdf.
    OSError
        The file system refuses.
    """
    import matplotlib as mpl  # noqa: PLC0415  (half a second that a campaign does not need)
    from matplotlib.figure import Figure  # noqa: PLC0415

    target = Path(out)
    if target.suffix.lower() not in PICTURES:
        raise DomainError(f"path plot: found {target.name!r}, allowed names ending in {', '.join(PICTURES)}")
    panels = [
        (p, back) for p in path for back in (False, True) if np.any((np.asarray(p.theta_s) > 90.0) == back)
    ]
    across = min(3, max(1, len(panels)))
    down = max(1, -(-len(panels) // across))
    with mpl.rc_context({"font.size": 9, "svg.hashsalt": "gonio"}):
        figure = Figure(figsize=(4.2 * across, 4.6 * down), layout="constrained")
        for k, (p, back) in enumerate(panels, 1):
            axes = figure.add_subplot(down, across, k, projection="polar")
            here = np.flatnonzero((p.theta_s > 90.0) == back)
            here = here[:: max(1, len(here) // SHOWN)]
            radius = np.where(p.theta_s > 90.0, 180.0 - p.theta_s, p.theta_s)[here]
            axes.plot(np.radians(p.phi_s[here]), radius, ".", markersize=1, rasterized=True, color="tab:blue")
            axes.set_ylim(0.0, 90.0)
            axes.set_title(
                f"theta_i {p.theta_i:g}°, phi_i {p.phi_i:g}°, {'back' if back else 'front'}\n"
                f"{len(p.theta_s):,} readings"
            )
        with replacing_file(target) as staged:
            figure.savefig(staged, format=target.suffix.lower().removeprefix("."), dpi=150)
