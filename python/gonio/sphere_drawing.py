"""A drawing of an integrating sphere: ports, beam and baffles, seen across the plane of incidence."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gonio._native import DomainError, IntegratingSphere
from gonio.files import check_file, replacing_file
from gonio.readings import PathLike
from gonio.simulated_path import PICTURES
from gonio.spheres import Sphere, read_sphere

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

NUMBERS = {"sample": "1", "detector": "2", "entrance": "3", "trap": "5"}
"""Numbers of the ports in figure 6.6 of the source chapter."""

COLOURS = {
    "sample": "#7b3294",
    "entrance": "#b8860b",
    "trap": "#c0392b",
    "detector": "#1f6fb2",
    "comparison": "#5e8c31",
    "auxiliary": "#8c564b",
}

_TURN = np.linspace(0.0, 2.0 * np.pi, 181)


RIM = 0.85
"""Ports whose middle lies so far out in a view are labelled there."""


def _circle(middle: Array, normal: Array, radius: float, view: Sequence[int]) -> Array:
    """A circle in space as a view shows it: (points, 2)."""
    first = np.cross(normal, [0.0, 1.0, 0.0] if abs(normal[1]) < 0.9 else [1.0, 0.0, 0.0])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    points = middle + radius * (np.outer(np.cos(_TURN), first) + np.outer(np.sin(_TURN), second))
    return np.asarray(points[:, view])


def draw_sphere(
    sphere: PathLike | Sphere, *, out: str | os.PathLike[str], theta_i: float | None = None
) -> None:
    """Draw a sphere as a picture: in the plane of incidence and across it, the sample at the bottom.

    Ports are drawn as wide as they are, with their share of the wall; the beam in yellow, its mirrored or
    unbent continuation in red.

    Parameters
    ----------
    sphere
        File of a sphere, the name of one that comes with gonio, or a `Sphere`.
    out
        The picture: .png, .svg or .pdf; it appears whole or not at all.
    theta_i
        Angle of incidence in degrees in place of the sphere's.

    Raises
    ------
    DomainError
        Another ending, or a sphere that cannot be built at this incidence.
    FormatError, OSError
        As `read_sphere`; the picture cannot be written.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415  (half a second that other verbs do not need)

    target = check_file(out)
    if target.suffix.lower() not in PICTURES:
        raise DomainError(f"out: found {target}, allowed {', '.join(PICTURES)}")
    described = sphere if isinstance(sphere, Sphere) else read_sphere(sphere)
    native = described.native(theta_i=theta_i)
    angle = math.radians(described.theta_i if theta_i is None else theta_i)
    figure = Figure(figsize=(11.0, 5.2))
    named: set[str] = set()
    views = (((0, 2), "in the plane of incidence"), ((1, 2), "across it"))
    for ax, (view, about) in zip(figure.subplots(1, 2), views, strict=True):
        _draw_wall(ax, native, view, named)
        bottom = -math.cos(math.radians(native.ports[0][2]))
        _draw_beam(ax, described, bottom, angle, flat=view[0] == 1)
        ax.set_aspect("equal")
        ax.set_xlim(-1.6, 1.6)
        ax.set_ylim(-1.4, 1.45)
        ax.axis("off")
        ax.text(0.0, -1.38, about, ha="center", va="top", fontsize=9, style="italic")
    figure.suptitle(
        f"{described.name}: {2e3 * described.settings['radius']:g} mm, wall {described.settings['wall']:g}, "
        f"{described.arrangement} at {math.degrees(angle):g}°, {described.method}",
        fontsize=10,
        y=0.94,
    )
    with replacing_file(target) as staged:
        figure.savefig(staged, format=target.suffix[1:].lower(), dpi=130, bbox_inches="tight")


def _draw_wall(ax: Axes, native: IntegratingSphere, view: Sequence[int], named: set[str]) -> None:
    """Wall, ports and baffles of a view; ports are labelled once, in the last view wherever they lie."""
    ax.plot(np.cos(_TURN), np.sin(_TURN), color="0.35", lw=2.5, zorder=1)
    for name, axis, half, share in native.ports:
        direction = np.asarray(axis)
        middle = direction * math.cos(math.radians(half))
        flat = direction[list(view)]
        on_rim = bool(np.linalg.norm(flat) > RIM)
        rim = _circle(middle, direction, math.sin(math.radians(half)), view)
        ax.plot(*rim.T, color=COLOURS[name], lw=4.0 if on_rim else 1.2, zorder=3)
        if name not in named and (on_rim or view[0] == 1):
            named.add(name)
            number = f" ({NUMBERS[name]})" if name in NUMBERS else ""
            x, z = 1.08 * flat if on_rim else flat + np.array([0.0, 0.08])
            aside = abs(x) > 0.35
            ax.text(
                x,
                z,
                f"{name}{number}\n{100 * share:.2f} %",
                color=COLOURS[name],
                ha=("left" if x > 0 else "right") if aside else "center",
                va="center" if aside and abs(z) < 0.8 else ("bottom" if z >= 0 else "top"),
                fontsize=9,
            )
    for centre, normal, radius in native.screens:
        outline = _circle(np.asarray(centre), np.asarray(normal), radius, view)
        ax.plot(*outline.T, color="0.2", lw=2, zorder=2)
        place = np.asarray(centre)[list(view)]
        if np.ptp(outline @ np.array([-place[1], place[0]])) > 0 and np.linalg.norm(place) > 0.3:
            ax.text(place[0], outline[:, 1].min() - 0.03, "baffle", ha="center", va="top", fontsize=9)


def _draw_beam(ax: Axes, described: Sphere, bottom: float, angle: float, *, flat: bool) -> None:
    """The beam to the sample, and its mirrored (unbent) way to the trap, as wide as it is."""
    width = described.settings["beam_radius"] / described.settings["radius"]
    sin = 0.0 if flat else math.sin(angle)
    onward = np.array([-sin, math.cos(angle)])
    towards = np.array([sin, math.cos(angle)])
    ways = [(towards, "#e8b923", 2.25), (onward, "#e07b5a", 2.0)]
    if described.arrangement == "transmission":
        ways[0] = (-onward, "#e8b923", 0.3)
    for direction, colour, length in ways:
        across = width * np.array([-direction[1], direction[0]])
        start = np.array([0.0, bottom])
        end = start + length * direction
        corners = np.array([start + across, end + across, end - across, start - across])
        ax.fill(*corners.T, color=colour, alpha=0.45, lw=0, zorder=0)
