"""Parts of the static figures: choice of the slice, scales, frames and labels."""

import math
from typing import Any, Literal

import numpy as np
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.patches import Circle

from gonio._drawing.directions import component_of, equal_area, side_of, unit_vectors
from gonio._drawing.mesh import Mesh
from gonio._drawing.shapes import Floats, MeasurementLike, Snapshot, snapshot
from gonio._native import DomainError

Quantity = Literal["dsf", "bsdf"]
Scale = Literal["log", "linear"]
Side = Literal["front", "back"]

MATCH = 0.05
"""An incidence is found when it lies within this many degrees of the one asked for."""

RING_LABELS = math.radians(75.0)
"""Azimuth at which the rings of a map are labelled."""

DATA, NEGATIVE, QUIET, UNMEASURED = "#1f5fa8", "#b0206a", "#5a6575", "#dfe3e8"
LABEL = {"dsf": "DSF [1/sr]", "bsdf": "BSDF [1/sr]"}


def choose(
    measurement: MeasurementLike, *, incidence: float | tuple[float, float] | None, channel: str | None
) -> Snapshot:
    """Find the slice of an incidence (theta_i, or theta_i and phi_i, degrees) and channel, else the first.

    Raises `DomainError` when there is none; it names what there is.
    """
    wanted = (incidence,) if isinstance(incidence, int | float) else (incidence or ())
    for s in measurement.slices:
        if channel is not None and s.channel != channel:
            continue
        if all(abs(a - b) <= MATCH for a, b in zip(wanted, (s.theta_i, s.phi_i), strict=False)):
            return snapshot(s)
    there = ", ".join(sorted({f"({s.theta_i:g}°, {s.phi_i:g}°) {s.channel}" for s in measurement.slices}))
    asked = f"{incidence if incidence is not None else 'any'}, channel {channel or 'any'}"
    raise DomainError(f"incidence: found {asked}, allowed {there or 'none, the measurement is empty'}")


def axes(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """Give the axes to draw into, new ones of `size` inches without any."""
    if ax is not None:
        return ax
    return pyplot.subplots(figsize=size, layout="constrained")[1]


def per(theta: Floats, quantity: Quantity, dsf: Floats) -> Floats:
    """Turn DSF values at extended or canonical polar angles (degrees) into `quantity`; NaN at the horizon."""
    if quantity == "dsf":
        return dsf
    cosine = np.abs(np.cos(np.radians(theta)))
    return np.where(cosine > 0.0175, dsf / np.maximum(cosine, 0.0175), np.nan)


def per_direction(mesh: Mesh, quantity: Quantity, dsf: Floats) -> Floats:
    """Give `quantity` at the readings of a mesh; cosines are taken as at least that of 89 degrees."""
    values = dsf[mesh.rows]
    return values if quantity == "dsf" else values / np.maximum(np.abs(mesh.vectors[:, 2]), 0.0175)


def bottom_of(values: Floats, floor: float | None) -> float:
    """Find the lower end of a logarithmic axis, a little under the noise floor or the weakest values."""
    positive = values[np.isfinite(values) & (values > 0.0)]
    if len(positive) == 0:
        return (floor or 1e-6) / 10.0
    weakest = float(np.percentile(positive, 2.0))
    least = min(floor, weakest) if floor and floor > weakest / 30.0 else weakest
    return max(least / 4.0, float(positive.max()) * 1e-7)


def span_of(s: Snapshot) -> tuple[float, float]:
    """Give the range of extended polar angles that the readings of a slice need."""
    front, back = bool((s.theta_s <= 90.0).any()), bool((s.theta_s > 90.0).any())
    return (-90.0 if front or not back else 90.0, 270.0 if back else 90.0)


def norm_of(values: Floats, scale: Scale, floor: float | None) -> Any:
    """Scale colours from the noise floor or the weakest values to the peak."""
    finite = values[np.isfinite(values)]
    positive = finite[finite > 0.0]
    if len(positive) == 0:
        return Normalize(0.0, 1.0)
    high = float(positive.max())
    if scale == "linear":
        return Normalize(0.0, high)
    low = max(float(np.percentile(positive, 2.0)), floor or 0.0, high * 1e-6)
    return LogNorm(min(low, high / 2.0), high)


def one_colour(colour: str) -> Colormap:
    """Make a colour map of a single colour."""
    return ListedColormap([colour, colour])


def title_of(measurement: MeasurementLike, s: Snapshot) -> str:
    """Name the sample, the incidence, the channel and the resolution."""
    parts = [measurement.sample_name or "unnamed sample", f"θi {s.theta_i:g}°, φi {s.phi_i:g}°", s.channel]
    if measurement.signature_fwhm:
        parts.append(f"resolution {measurement.signature_fwhm:.2g}°")
    return " · ".join(parts).replace("$", r"\$")


def default_side(s: Snapshot) -> Side:
    """Choose the side of incidence when it was measured, else the other one."""
    own: Side = "back" if s.theta_i > 90.0 else "front"
    there = {side_of(t) for t in s.theta_s}
    other: Side = "front" if own == "back" else "back"
    return own if own in there or not there else other


def mark_directions(ax: Axes, s: Snapshot, span: tuple[float, float]) -> None:
    """Draw the incidence, mirror and through directions into a profile."""
    incidence = -s.theta_i if s.theta_i <= 90.0 else 360.0 - s.theta_i
    marks = (("incidence", incidence, "-"), ("mirror", s.theta_i, "--"), ("through", 180.0 - s.theta_i, ":"))
    names: dict[float, str] = {}
    for name, at, style in marks:
        if span[0] <= at <= span[1]:
            ax.axvline(at, color=QUIET, linewidth=0.8, linestyle=style, zorder=0)
            names[round(at, 1)] = f"{names[round(at, 1)]} = {name}" if round(at, 1) in names else name
    for at, name in names.items():
        ax.annotate(
            name, (at, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2), textcoords="offset points",
            ha="center", va="bottom", fontsize="small", color=QUIET,
        )  # fmt: skip
    if span == (-90.0, 270.0):
        ax.axvline(90.0, color="black", linewidth=0.8)


def map_frame(ax: Axes, s: Snapshot, side: Side) -> None:
    """Draw rings of polar angle, azimuths and the marked directions into an equal-area map."""
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set(xlim=(-1.2, 1.2), ylim=(-1.2, 1.2))
    for theta in (30.0, 60.0):
        radius = math.sqrt(1.0 - math.cos(math.radians(theta)))
        ring = Circle((0.0, 0.0), radius, fill=False, edgecolor="white", linewidth=0.6, alpha=0.7)
        ax.add_patch(ring)
        x, y = radius * math.cos(RING_LABELS), radius * math.sin(RING_LABELS)
        label = f"{theta if side == 'front' else 180.0 - theta:g}°"
        ax.text(x, y, label, color="white", fontsize="x-small", ha="center", va="center")
    for azimuth in (0, 90, 180, 270):
        x, y = 1.1 * math.cos(math.radians(azimuth)), 1.09 * math.sin(math.radians(azimuth))
        label = f"φ = {azimuth}°" if azimuth == 0 else f"{azimuth}°"
        ax.text(x, y, label, fontsize="x-small", ha="center", va="center", color=QUIET)
    mirror = (s.phi_i + 180.0) % 360.0
    marks = (("^", s.theta_i, s.phi_i), ("o", s.theta_i, mirror), ("D", 180.0 - s.theta_i, mirror))
    for symbol, theta, phi in marks:
        if side_of(theta) == side:
            px, py = equal_area(unit_vectors(theta, phi), side)
            ax.plot(
                px,
                py,
                symbol,
                markerfacecolor="none",
                markeredgecolor="white",
                markersize=9,
                markeredgewidth=2.6,
            )
            ax.plot(
                px,
                py,
                symbol,
                markerfacecolor="none",
                markeredgecolor=NEGATIVE,
                markersize=9,
                markeredgewidth=1.2,
            )


def lobe_frame(ax: Any, s: Snapshot) -> None:
    """Draw the sample plane, the incidence and the mirror or through direction into 3-D axes."""
    angle = np.radians(np.arange(0.0, 361.0, 4.0))
    ax.plot(np.cos(angle), np.sin(angle), 0.0 * angle, color=QUIET, linewidth=0.7)
    ax.text(1.15, 0.0, 0.0, "φ = 0°", fontsize="x-small", color=QUIET)
    mirror = (s.phi_i + 180.0) % 360.0
    lines = [("incidence", s.theta_i, s.phi_i, "-", NEGATIVE)]
    measured = {component_of(s.theta_i, side_of(t)) for t in s.theta_s}
    lines += [("mirror", s.theta_i, mirror, "--", "black")] if "reflection" in measured else []
    lines += [("through", 180.0 - s.theta_i, mirror, ":", "black")] if "transmission" in measured else []
    for name, theta, phi, style, colour in lines:
        x, y, z = 1.2 * unit_vectors(theta, phi)
        ax.plot([0.0, x], [0.0, y], [0.0, z], style, color=colour, linewidth=1.2)
        ax.text(1.08 * x, 1.08 * y, 1.08 * z, name, fontsize="small", color=colour, ha="center")
    front, back = bool((s.theta_s <= 90.0).any()), bool((s.theta_s > 90.0).any())
    low, high = (-1.1 if back else -0.15, 1.1 if front else 0.15)
    ax.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), zlim=(low, high))
    ax.set_box_aspect((2.2, 2.2, high - low), zoom=1.25)
    ax.set_axis_off()
    ax.view_init(elev=22.0, azim=s.phi_i + 75.0)
