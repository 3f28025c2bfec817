"""Pictures of a fit: readings and prediction in the plane of incidence, residuals over the hemisphere."""

from __future__ import annotations

import base64
import dataclasses
import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import FuncFormatter, NullFormatter
from matplotlib.tri import Triangulation

from gonio._drawing import figures
from gonio._drawing.directions import SIDES, component_of, equal_area, unit_vectors
from gonio._drawing.mesh import Mesh, triangulate
from gonio._drawing.noise import noise_floor
from gonio._drawing.numbers import angle
from gonio._drawing.section import section
from gonio._drawing.shapes import Floats, Snapshot, unusable
from gonio.fit_results import Fit
from gonio.reporting.wording import channel_label

FITTED = "#c2560a"
LIMITS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Ends that the colour scale of the residuals may have."""

MOST_CURVES = 6
"""Models whose errors over the incidence are drawn."""

DPI = 110


def relative_residuals(s: Snapshot, predicted: Floats) -> Floats:
    """Prediction minus reading, over the reading or twice its u if that is larger; NaN if unused."""
    used = np.isfinite(predicted) & ~unusable(s.flags, s.dsf)
    scale = np.maximum(np.abs(s.dsf), 2.0 * np.nan_to_num(s.u_dsf))
    out = np.full(len(s.dsf), np.nan)
    np.divide(predicted - s.dsf, scale, out=out, where=used & (scale > 0.0))
    return out


def limit_of(residuals: Sequence[Floats]) -> float:
    """The end of a colour scale that holds 98 % of the residuals."""
    found = np.abs(np.concatenate([np.asarray(r)[np.isfinite(r)] for r in residuals] or [np.empty(0)]))
    largest = float(np.percentile(found, 98.0)) if len(found) else 0.0
    return next((limit for limit in LIMITS if largest <= limit), LIMITS[-1])


def slice_figure(s: Snapshot, predicted: Floats, *, limit: float) -> str:
    """Profile and residual maps of one slice as a PNG in base64."""
    residual = relative_residuals(s, predicted)
    used = dataclasses.replace(s, dsf=np.where(np.isfinite(residual), s.dsf, np.nan))
    meshes = {side: triangulate(used, side) for side in SIDES}
    meshes = {side: mesh for side, mesh in meshes.items() if len(mesh.rows)}
    figure = Figure(figsize=(8.0 + 3.3 * max(len(meshes), 1), 3.5), layout="constrained")
    grid = figure.add_gridspec(1, 1 + max(len(meshes), 1), width_ratios=[2.25] + [1.0] * max(len(meshes), 1))
    _profile(figure.add_subplot(grid[0]), used, predicted, meshes)
    drawn, places = None, []
    for column, mesh in enumerate(meshes.values()):
        ax = figure.add_subplot(grid[1 + column])
        drawn = _map(ax, s, mesh, residual, limit=limit)
        places.append(ax)
    if drawn is not None:
        bar = figure.colorbar(drawn, ax=places, shrink=0.85, pad=0.02, extend="both")
        bar.set_label("(model − reading) / reading [%]")
    return _png(figure)


def _profile(ax: Axes, s: Snapshot, predicted: Floats, meshes: dict[str, Mesh]) -> None:
    fitted = dataclasses.replace(s, dsf=np.where(np.isfinite(s.dsf), predicted, np.nan))
    measured, model = section(s, meshes), section(fitted, meshes)
    floor = noise_floor(s)
    marks = s.dsf[measured.rows]
    bottom = figures.bottom_of(np.r_[measured.dsf, marks], floor)
    low, high = (np.maximum(measured.dsf + k * measured.u_dsf, bottom) for k in (-2.0, 2.0))
    ax.fill_between(measured.theta, low, high, color=figures.DATA, alpha=0.2, linewidth=0.0, label="± 2 u")
    ax.plot(
        measured.rows_theta,
        np.maximum(marks, bottom),
        ".",
        color=figures.DATA,
        markersize=3.5,
        label="readings",
    )
    ax.plot(
        model.theta,
        np.maximum(model.dsf, bottom),
        color=FITTED,
        linewidth=1.5,
        label="model, as the instrument sees it",
    )
    if floor is not None:
        ax.axhline(floor, color=figures.QUIET, linewidth=0.9, linestyle=":", label="noise floor")
    span = figures.span_of(s)
    figures.mark_directions(ax, s, span)
    finite = np.r_[measured.dsf, marks, model.dsf]
    finite = finite[np.isfinite(finite)]
    top = float(finite.max()) if len(finite) and finite.max() > 0.0 else 1.0
    ax.set_yscale("log")
    ax.set(xlim=span, ylim=(bottom, 2.0 * top), ylabel="DSF [1/sr]")
    ax.set_xlabel(f"Extended polar angle θs in the plane φ = {measured.plane_phi:g}° [deg]")
    ax.set_xticks(np.arange(span[0], span[1] + 1.0, 30.0))
    ax.grid(color="#d9dee5", linewidth=0.6)
    ax.legend(frameon=False, fontsize="small", ncols=4, loc="upper center", bbox_to_anchor=(0.5, -0.15))


def _map(ax: Axes, s: Snapshot, mesh: Mesh, residual: Floats, *, limit: float) -> Any:
    side = mesh.side
    x, y = equal_area(mesh.vectors, side).T
    values = 100.0 * residual[mesh.rows]
    norm = Normalize(-100.0 * limit, 100.0 * limit)
    ax.add_patch(
        Circle((0.0, 0.0), 1.0, facecolor=figures.UNMEASURED, edgecolor=figures.QUIET, linewidth=0.8)
    )
    style: dict[str, Any] = {"norm": norm, "cmap": "RdBu_r", "rasterized": True}
    if len(mesh.triangles):
        drawn: Any = ax.tripcolor(Triangulation(x, y, mesh.triangles), values, shading="gouraud", **style)
    else:
        drawn = ax.scatter(x, y, c=values, s=10, **style)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set(xlim=(-1.22, 1.22), ylim=(-1.22, 1.22))
    for theta in (30.0, 60.0):
        radius = np.sqrt(1.0 - np.cos(np.radians(theta)))
        ax.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor="#8a94a3", linewidth=0.6))
        label = f"{theta if side == 'front' else 180.0 - theta:g}°"
        ax.text(
            0.26 * radius,
            0.97 * radius,
            label,
            fontsize="x-small",
            color=figures.QUIET,
            ha="center",
            va="bottom",
        )
    for azimuth in (0, 90, 180, 270):
        at = np.radians(azimuth)
        label = f"φ {azimuth}°" if azimuth == 0 else f"{azimuth}°"
        ax.text(
            1.13 * np.cos(at),
            1.1 * np.sin(at),
            label,
            fontsize="x-small",
            ha="center",
            va="center",
            color=figures.QUIET,
        )
    mirror = (s.phi_i + 180.0) % 360.0
    for symbol, theta, phi in (
        ("^", s.theta_i, s.phi_i),
        ("o", s.theta_i, mirror),
        ("D", 180.0 - s.theta_i, mirror),
    ):
        if (theta <= 90.0) == (side == "front"):
            px, py = equal_area(unit_vectors(theta, phi), side)
            ax.plot(px, py, symbol, markerfacecolor="none", markeredgecolor="black", markersize=8)
    ax.set_title(f"residuals, {component_of(s.theta_i, side)}", fontsize="small")
    return drawn


def errors_figure(fits: Sequence[Fit]) -> str | None:
    """Errors at left-out incidences over theta_i, one curve a model; None where nothing was left out."""
    shown = [f for f in _distinct(fits) if f.held_out][:MOST_CURVES]
    if not shown:
        return None
    figure = Figure(figsize=(8.6, 4.2), layout="constrained")
    ax = figure.add_subplot()
    for k, f in enumerate(shown):
        theta = np.array([h.theta_i for h in f.held_out])
        error = 100.0 * np.array([h.relative_l1 for h in f.held_out])
        levels = np.unique(np.round(theta, 3))
        mean = [error[np.round(theta, 3) == t].mean() for t in levels]
        line = ax.plot(
            levels, mean, "o-", color=f"C{k}", markersize=4, linewidth=2.2 if k == 0 else 1.2, label=f.model
        )
        if len(levels) < len(theta):
            ax.plot(theta, error, ".", color=line[0].get_color(), markersize=3, alpha=0.5)
    ax.set_yscale("log")
    ends = ax.get_ylim()
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    ax.yaxis.set_major_formatter(plain)
    # One decade or less has too few decades to be read by.
    ax.yaxis.set_minor_formatter(plain if ends[1] < 15.0 * ends[0] else NullFormatter())
    ax.set(xlabel="Left-out angle of incidence θi [deg]", ylabel="Relative L1 error [%]")
    ax.grid(color="#d9dee5", linewidth=0.6, which="both")
    ax.legend(frameon=False, fontsize="small", ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.16))
    return _png(figure)


def _distinct(fits: Sequence[Fit]) -> list[Fit]:
    """Fits without those that describe the readings exactly as one before them does."""
    kept: list[Fit] = []
    for f in fits:
        errors = np.array([h.relative_l1 for h in f.held_out])
        same = (
            len(k.held_out) == len(errors)
            and np.allclose([h.relative_l1 for h in k.held_out], errors, rtol=1e-3)
            for k in kept
        )
        if not any(same):
            kept.append(f)
    return kept


def caption(s: Snapshot) -> str:
    """Incidence and channel of a picture."""
    azimuth = f", φi {angle(s.phi_i)}°"
    return f"θi {angle(s.theta_i)}°{azimuth} · {channel_label(s.channel)}"


def _png(figure: Figure) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, facecolor="white", metadata={"Software": None})
    return base64.b64encode(buffer.getvalue()).decode()
