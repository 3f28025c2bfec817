"""`gonio simulate --geometry`: the BSDF or raw readings of a part that exists as geometry."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

import gonio
from gonio.cli.running import out, print_json, progress_bar, warn
from gonio.device_readings import INCIDENCES

Geometry = Annotated[
    list[Path] | None,
    typer.Option(
        "--geometry",
        metavar="FILE",
        help="Scene file of a part about z = 0: BSDF to -o FILE.xml, readings to -o DIRECTORY; repeat it.",
    ),
]
Window = Annotated[
    str | None,
    typer.Option(metavar="X,Y,X,Y", help="Rectangle of the geometry that rays are sent through; all of it."),
]
Periodic = Annotated[
    bool, typer.Option("--periodic", help="The window is one period of geometry that goes on beyond it.")
]
Unit = Annotated[float, typer.Option(help="Metres of a unit of the geometry that is read.")]
Basis = Annotated[
    str,
    typer.Option(
        help="Of the geometry's BSDF: Klems patches full, half, quarter; "
        "tensor trees ttree4, ttree3 (isotropic)."
    ),
]
Levels = Annotated[int, typer.Option(help="Finest cells of a tensor tree have the side 2^-LEVELS, 2 to 6.")]
Tolerance = Annotated[
    float, typer.Option(help="Relative L1 that merging cells of a tensor tree beyond their errors may add.")
]
Error = Annotated[float, typer.Option(help="Relative error of the geometry's BSDF.")]
Rays = Annotated[
    int | None, typer.Option(help="Rays through the geometry from each patch, in place of --error.")
]
Joined = Annotated[
    int, typer.Option(help="Scatterings of an incidence joined with the readings of geometry, at most.")
]


def simulate_geometry(
    files: list[Path],
    to: Path,
    *,
    window: str | None,
    periodic: bool,
    basis: str,
    levels: int,
    tolerance: float,
    error: float,
    rays: int | None,
    seed: int,
    json: bool,
) -> None:
    """Write the BSDF of a part as XML and say what is known of it."""
    with progress_bar(hidden=json) as progress:
        found = gonio.simulate_geometry(
            *files,
            window=None if window is None else _numbers(window),
            periodic=periodic,
            basis=basis,
            levels=levels,
            tolerance=tolerance,
            error=error,
            rays=rays,
            seed=seed,
            progress=progress,
        )
    found.write(to, name=files[-1].stem)
    for text in found.warnings:
        warn(text)
    albedo = {
        (side, component): found.albedo(side=side, component=component)
        for side, component in found.relative_error
    }
    cells = found.cells
    if json:
        print_json(
            {
                "out": to,
                "rays": found.rays,
                "basis": found.basis,
                "cells": cells,
                "window": found.window,
                "relative_error": {" ".join(key): value for key, value in found.relative_error.items()},
                "albedo_normal": {" ".join(key): value for key, value in albedo.items()},
                "warnings": found.warnings,
            }
        )
        return
    of = "patches" if cells is None else f"incident cells, {cells} cells in all"
    out.print(f"{to}: {found.rays} rays from each of the {found.basis} basis' {of}")
    for (side, component), value in found.relative_error.items():
        out.print(
            f"  {side} {component}: albedo {albedo[side, component]:.4f} at normal incidence,"
            f" error of a pair of {'patches' if cells is None else 'cells'} {100 * value:.1f} %"
        )


def simulate_readings(
    files: list[Path],
    to: Path,
    *,
    window: str | None,
    periodic: bool,
    unit: float,
    seed: int,
    incidences: list[tuple[float, float]] | None,
    components: list[Literal["reflection", "transmission"]] | None,
    joined: int,
    instrument: str | None,
    settings: dict[str, float],
    force: bool,
    json: bool,
) -> None:
    """Write raw readings of a part and say how well they are known."""
    with progress_bar(hidden=json) as progress:
        found = gonio.simulate_readings(
            *files,
            out=to,
            window=None if window is None else _numbers(window),
            periodic=periodic,
            unit=unit,
            seed=seed,
            incidences=INCIDENCES if incidences is None else incidences,
            components=["reflection"] if components is None else components,
            joined=joined,
            instrument=instrument,
            settings=settings,
            force=force,
            progress=progress,
        )
    for text in found.warnings:
        warn(text)
    if json:
        print_json(
            {
                "out": found.out,
                "geometry": found.name,
                "seed": found.seed,
                "readings": found.readings,
                "sample": found.sample,
                "beam": found.beam,
                "dark": found.dark,
                "monte_carlo": [vars(k) for k in found.monte_carlo],
                "warnings": found.warnings,
            }
        )
        return
    out.print(f"{found.out}: {found.readings} readings of {found.name}")
    for k in found.monte_carlo:
        out.print(
            f"  {k.joined} scatterings joined, {k.met} rays met:"
            f" Monte-Carlo part {k.median:.2f} of the noise (median), {k.worst:.2f} at most"
        )
    for path in (*found.sample, *found.beam, *found.dark):
        out.print(f"  {path}")


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"found {text!r}, allowed four numbers", param_hint="--window") from None
