"""Static figures of a measurement for papers and laboratory notes: profile, map, DHR, lobe.

Every function draws into the matplotlib axes it is given, or into new ones, and returns the axes; save the
figure as PNG or PDF with `ax.figure.savefig`. Angles are degrees, DSF and BSDF 1/sr. Like the report, the
figures join neighbouring readings only and leave unmeasured regions open.

    import gonio
    from gonio import plotting

    ax = plotting.plot_profile(gonio.Measurement.load("out"), incidence=30)
    ax.figure.savefig("profile.pdf")
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib import colormaps, pyplot
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.patches import Circle
from matplotlib.tri import Triangulation
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from gonio._drawing import figures
from gonio._drawing.directions import SIDES, component_of, equal_area
from gonio._drawing.figures import Quantity, Scale, Side
from gonio._drawing.mesh import triangulate
from gonio._drawing.noise import noise_floor
from gonio._drawing.section import section
from gonio._drawing.shapes import MeasurementLike
from gonio._drawing.thinning import thin

MOST_FACES = 6_000
"""Readings of a hemisphere that a static lobe is drawn from."""


def plot_profile(
    measurement: MeasurementLike,
    *,
    incidence: float | tuple[float, float] | None = None,
    channel: str | None = None,
    quantity: Quantity = "dsf",
    scale: Scale = "log",
    ax: Axes | None = None,
) -> Axes:
    """Plot the profile in the plane of incidence with its 95 % band (k = 2) over the extended polar angle.

    Parameters
    ----------
    measurement
        The processed sample.
    incidence
        theta_i, or (theta_i, phi_i), in degrees; the first slice without one.
    channel
        Spectral channel; the first one without.
    quantity
        "dsf" or "bsdf"; a BSDF is left out within a degree of the horizon, where it has no bound.
    scale
        "log" or "linear"; on a logarithmic scale negative readings are marked at the lower edge.
    ax
        Axes to draw into.

    Returns ------- Axes x: extended polar angle, −90…90 over the front, 90…270 over the back; the mirror
    direction is positive.

    Raises
    ------
    DomainError
        No slice has this incidence and channel.
    """
    s = figures.choose(measurement, incidence=incidence, channel=channel)
    ax = figures.axes(ax, (9.0, 4.2))
    profile = section(s)
    y, u = (
        figures.per(profile.theta, quantity, profile.dsf),
        figures.per(profile.theta, quantity, profile.u_dsf),
    )
    marks = figures.per(profile.rows_theta, quantity, s.dsf[profile.rows])
    floor = noise_floor(s)
    bottom = figures.bottom_of(np.r_[y, marks], floor) if scale == "log" else -math.inf
    shown = np.where(y > 0.0, y, np.nan) if scale == "log" else y
    ax.fill_between(
        profile.theta, np.maximum(y - 2.0 * u, bottom), np.maximum(y + 2.0 * u, bottom),
        color=figures.DATA, alpha=0.22, linewidth=0.0, label="95 % band (k = 2)",
    )  # fmt: skip
    ax.plot(profile.theta, shown, color=figures.DATA, linewidth=1.4, label="section through the readings")
    negative = marks < 0.0
    ax.plot(
        profile.rows_theta[~negative], marks[~negative], ".", color="#33445c", markersize=3, label="reading"
    )
    if negative.any():
        at = np.full(int(negative.sum()), bottom * 1.15) if scale == "log" else marks[negative]
        ax.plot(
            profile.rows_theta[negative],
            at,
            "v",
            color=figures.NEGATIVE,
            markersize=4,
            label="negative reading",
        )
    if floor is not None and quantity == "dsf":
        ax.axhline(floor, color=figures.QUIET, linewidth=0.9, linestyle=":", label="noise floor")
    span = figures.span_of(s)
    figures.mark_directions(ax, s, span)
    ax.set(xlim=span, xlabel=f"Extended polar angle θs in the plane φ = {profile.plane_phi:g}° [deg]")
    ax.set_ylabel(figures.LABEL[quantity])
    ax.set_xticks(np.arange(span[0], span[1] + 1.0, 30.0))
    if scale == "log":
        ax.set_yscale("log")
        finite = np.r_[y, marks][np.isfinite(np.r_[y, marks])]
        top = float(finite.max()) if len(finite) and finite.max() > 0.0 else 1.0
        ax.set_ylim(bottom, top * 2.0)
    ax.set_title(figures.title_of(measurement, s), fontsize="medium", loc="left", pad=16)
    ax.grid(color="#d9dee5", linewidth=0.6)
    ax.legend(frameon=False, fontsize="small", ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.16))
    return ax


def plot_heatmap(
    measurement: MeasurementLike,
    *,
    incidence: float | tuple[float, float] | None = None,
    channel: str | None = None,
    side: Side | None = None,
    quantity: Quantity = "dsf",
    scale: Scale = "log",
    readings: bool = False,
    ax: Axes | None = None,
) -> Axes:
    """Plot one hemisphere as an equal-area map seen from the front; grey is not measured.

    `side` is the side of incidence without one, or the only one that was measured. `readings` marks each
    reading. The other parameters and errors are those of `plot_profile`. Negative values are drawn in purple-
    red.
    """
    s = figures.choose(measurement, incidence=incidence, channel=channel)
    side = side or figures.default_side(s)
    ax = figures.axes(ax, (5.6, 5.2))
    mesh = triangulate(s, side)
    values = figures.per_direction(mesh, quantity, s.dsf)
    norm = figures.norm_of(values, scale, noise_floor(s))
    x, y = equal_area(mesh.vectors, side).T
    ground = {"facecolor": figures.UNMEASURED, "edgecolor": figures.QUIET, "linewidth": 0.8, "zorder": 0}
    ax.add_patch(Circle((0.0, 0.0), 1.0, **ground))
    drawn: Any
    if len(mesh.triangles):
        shown = np.maximum(values, norm.vmin) if scale == "log" else values
        style = {"norm": norm, "cmap": "viridis", "shading": "gouraud", "rasterized": True}
        drawn = ax.tripcolor(Triangulation(x, y, mesh.triangles), shown, **style)
        below = mesh.triangles[values[mesh.triangles].mean(axis=1) < 0.0]
        if len(below):
            purple = figures.one_colour(figures.NEGATIVE)
            ax.tripcolor(
                Triangulation(x, y, below), facecolors=np.ones(len(below)), cmap=purple, rasterized=True
            )
        if readings:
            ax.plot(x, y, ",", color="black", alpha=0.6)
    else:
        drawn = ax.scatter(x, y, c=values, norm=norm, cmap="viridis", s=14)
    ax.figure.colorbar(drawn, ax=ax, label=figures.LABEL[quantity], shrink=0.8)
    figures.map_frame(ax, s, side)
    title = f"{figures.title_of(measurement, s)}\n{component_of(s.theta_i, side)}, {side}"
    ax.set_title(title, fontsize="medium", loc="left")
    return ax


def plot_dhr(measurement: MeasurementLike, *, ax: Axes | None = None) -> Axes:
    """Plot DHR and DHT over the angle of incidence with expanded uncertainties (k = 2).

    Open marks show the part that readings cover, without the extrapolated one. One line a component, channel
    and azimuth of incidence.
    """
    ax = figures.axes(ax, (6.4, 4.2))
    series: dict[tuple[str, str, float], list[tuple[float, float, float, float]]] = {}
    for s in measurement.slices:
        for i in s.integrals:
            key = (component_of(s.theta_i, str(i.side)), str(s.channel), round(float(s.phi_i), 3))
            point = (float(s.theta_i), float(i.value), float(i.u), float(i.value) - float(i.extrapolated))
            series.setdefault(key, []).append(point)
    channels = {key[1] for key in series}
    azimuths = {key[2] for key in series}
    extrapolated = False
    for number, (component, name, phi) in enumerate(sorted(series)):
        theta, value, u, measured = np.array(sorted(series[component, name, phi])).T
        words = ["DHR" if component == "reflection" else "DHT"]
        words += [name] if len(channels) > 1 else []
        words += [f"φi {phi:g}°"] if len(azimuths) > 1 else []
        style = "-o" if component == "reflection" else ":D"
        colour = f"C{number % 10}"
        ax.errorbar(
            theta,
            value,
            yerr=2.0 * u,
            fmt=style,
            color=colour,
            capsize=3,
            markersize=5,
            label=" ".join(words),
        )
        if not np.allclose(measured, value, rtol=5e-5, atol=0.0):
            ax.plot(theta, measured, "o", markerfacecolor="none", markeredgecolor=colour, markersize=5)
            extrapolated = True
    if extrapolated:
        ax.plot([], [], "o", markerfacecolor="none", markeredgecolor=figures.QUIET, label="measured part")
    if series:
        ax.legend(frameon=False, fontsize="small")
    ax.set(xlabel="Angle of incidence θi [deg]", ylabel="DHR, DHT [1], ± k·u with k = 2")
    ax.set_title(measurement.sample_name or "unnamed sample", fontsize="medium", loc="left")
    ax.grid(color="#d9dee5", linewidth=0.6)
    return ax


def plot_lobe(
    measurement: MeasurementLike,
    *,
    incidence: float | tuple[float, float] | None = None,
    channel: str | None = None,
    quantity: Quantity = "dsf",
    scale: Scale = "log",
    ax: Any = None,
) -> Any:
    """Plot the lobe in space: the surface through the readings at a radius that grows with the value.

    On a logarithmic scale the radius starts at the noise floor or at the weakest values. `ax` are 3-D axes.
    The other parameters and errors are those of `plot_profile`. At most 6000 readings a hemisphere are drawn,
    every peak kept.
    """
    s = figures.choose(measurement, incidence=incidence, channel=channel)
    if ax is None:
        ax = pyplot.figure(figsize=(6.2, 5.6)).add_subplot(projection="3d")
    floor = noise_floor(s)
    peak = float(np.nanmax(np.abs(s.dsf), initial=0.0))
    knee = max(floor or 0.0, 1e-4 * peak, 1e-12)
    meshes = [thin(triangulate(s, side), s.dsf, most=MOST_FACES, floor=knee) for side in SIDES]
    values = [figures.per_direction(mesh, quantity, s.dsf) for mesh in meshes]
    norm = figures.norm_of(np.concatenate(values), scale, floor)
    for mesh, value in zip(meshes, values, strict=True):
        radius = np.clip(np.asarray(norm(np.maximum(value, norm.vmin)), dtype=float), 0.0, 1.2)
        points = mesh.vectors * radius[:, None]
        if len(mesh.triangles):
            colour = colormaps["viridis"](radius[mesh.triangles].mean(axis=1))
            style = {"facecolors": colour, "shade": True, "linewidth": 0.0, "antialiased": False}
            ax.add_collection3d(Poly3DCollection(points[mesh.triangles], **style))
        elif len(points):
            ax.scatter(*points.T, c=radius, cmap="viridis", vmin=0.0, vmax=1.0, s=8)
    figures.lobe_frame(ax, s)
    mappable = ScalarMappable(norm=norm, cmap="viridis")
    ax.figure.colorbar(mappable, ax=ax, label=figures.LABEL[quantity], shrink=0.65, pad=0.02)
    ax.set_title(figures.title_of(measurement, s), fontsize="medium", loc="left")
    return ax
