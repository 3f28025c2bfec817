"""Pictures of two models side by side: profiles in the plane of incidence, and maps of where they differ."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gonio._native import Bsdf, DomainError
from gonio.comparing import ComparedIncidence, ModelComparison
from gonio.files import check_file, replacing_file
from gonio.readings import PathLike
from gonio.working import Progress, silent

SUFFIXES = (".png", ".pdf", ".svg")
MOST_ROWS = 24
"""Incidences of one picture; a comparison of more is drawn at evenly chosen ones."""
_PIXELS = 181
_LIMIT = 0.5
"""Relative difference at which the colours of a map end."""

Array = NDArray[np.float64]


def compare_picture(
    comparison: ModelComparison,
    *,
    out: PathLike,
    names: tuple[str, str] = ("a", "b"),
    progress: Progress = silent,
) -> None:
    """Draw a comparison: for each incidence the profiles of both models and a map of their difference.

    The profile is the DSF in the plane of incidence over the extended polar angle, the mirror (unbent)
    direction positive. The map shows the hemisphere in equal projected solid angle, seen along the normal, x
    to the right: (DSF_b - DSF_a) over DSF_a, and over a thousandth of the peak where that is more.

    Parameters
    ----------
    comparison
        What `gonio.compare` found.
    out
        The file: .png, .pdf or .svg.
    names
        What the two are called in the picture.
    progress
        Called with stage, parts done and parts in all.

    Raises
    ------
    DomainError
        Another ending of the file, or a comparison without incidences.
    OSError
        The operating system refuses; nothing is left behind.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415  (half a second that other verbs do not need)

    target = check_file(out)
    if target.suffix.lower() not in SUFFIXES:
        raise DomainError(f"out: found the ending {target.suffix!r}, allowed {', '.join(SUFFIXES)}")
    rows = _chosen(comparison.rows)
    if not rows:
        raise DomainError("comparison: found no incidence, allowed at least one")
    figure = Figure(figsize=(10.0, 2.9 * len(rows)), layout="constrained")
    axes = figure.subplots(len(rows), 2, squeeze=False, width_ratios=(2.2, 1.0))
    channel_b = dict(comparison.channels)
    image = None
    for k, (row, (profile, plane)) in enumerate(zip(rows, axes, strict=True)):
        progress("drawing", k, len(rows))
        models = ((comparison.a, row.channel), (comparison.b, channel_b[row.channel]))
        _draw_profile(profile, row, models, names)
        image = _draw_map(plane, row, models)
    if image is not None:
        bar = figure.colorbar(image, ax=axes[:, 1].tolist(), location="bottom", shrink=0.8, aspect=30)
        bar.set_label(f"({names[1]} − {names[0]}) / {names[0]}")
    progress("drawing", len(rows), len(rows))
    with replacing_file(target) as staged:
        figure.savefig(staged, format=target.suffix.lower().removeprefix("."), dpi=110)


def _chosen(rows: list[ComparedIncidence]) -> list[ComparedIncidence]:
    if len(rows) <= MOST_ROWS:
        return rows
    return [rows[k] for k in np.linspace(0, len(rows) - 1, MOST_ROWS).round().astype(int)]


Models = tuple[tuple[Bsdf, str], tuple[Bsdf, str]]


def _dsf(model: tuple[Bsdf, str], row: ComparedIncidence, theta_s: Array, phi_s: Array) -> Array:
    bsdf, channel = model
    f = bsdf.eval(theta_i=row.theta_i, phi_i=row.phi_i, theta_s=theta_s, phi_s=phi_s, channel=channel)
    return f * np.abs(np.cos(np.radians(theta_s)))


def _up(row: ComparedIncidence) -> bool:
    """Whether the scattered light leaves from the front."""
    return (row.side == "front") == (row.component == "reflection")


def _draw_profile(ax: Any, row: ComparedIncidence, models: Models, names: tuple[str, str]) -> None:
    mirror = row.theta_i if row.theta_i <= 90.0 else 180.0 - row.theta_i
    near = mirror + np.concatenate([-np.geomspace(20.0, 0.02, 120), [0.0], np.geomspace(0.02, 20.0, 120)])
    angle = np.unique(np.concatenate([np.linspace(-89.0, 89.0, 357), near[np.abs(near) < 89.5]]))
    theta = np.abs(angle)
    theta_s = theta if _up(row) else 180.0 - theta
    phi_s = np.where(angle >= 0.0, row.phi_i + 180.0, row.phi_i) % 360.0
    for model, name, style in zip(models, names, ("-", "--"), strict=True):
        dsf = _dsf(model, row, theta_s, phi_s)
        ax.plot(angle, np.where(dsf > 0.0, dsf, np.nan), style, label=name, linewidth=1.2)
    ax.set_yscale("log")
    ax.set_xlim(-90.0, 90.0)
    ax.set_ylabel("DSF / sr⁻¹")
    ax.set_title(
        f"{row.side} {row.component}, {row.channel}, θi {row.theta_i:g}°, φi {row.phi_i:g}°: "
        f"relative L1 {100 * row.rel_l1:.2f} %",
        fontsize="small",
    )
    ax.grid(alpha=0.3)
    ax.legend(fontsize="small", loc="upper left")


def _draw_map(ax: Any, row: ComparedIncidence, models: Models) -> Any:
    x = (np.arange(_PIXELS) - _PIXELS // 2) / (_PIXELS // 2)
    xx, yy = np.meshgrid(x, x)
    r = np.hypot(xx, yy)
    inside = r < 0.999
    theta = np.degrees(np.arcsin(np.where(inside, r, 0.0)))
    phi = np.degrees(np.arctan2(yy, xx)) % 360.0
    theta_s = theta if _up(row) else 180.0 - theta
    a, b = (_dsf(model, row, theta_s, phi) for model in models)
    floor = max(1e-3 * float(a[inside].max()), 1e-12)
    difference = np.where(inside, (b - a) / np.maximum(a, floor), np.nan)
    image = ax.imshow(
        difference, origin="lower", extent=(-1, 1, -1, 1), cmap="RdBu_r", vmin=-_LIMIT, vmax=_LIMIT
    )
    ax.set_axis_off()
    return image
