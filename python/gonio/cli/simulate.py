"""`gonio simulate`: raw files of a known material."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

import typer

import gonio
from gonio.cli.geometry import (
    Basis,
    Error,
    Geometry,
    Joined,
    Levels,
    Periodic,
    Rays,
    Tolerance,
    Unit,
    Window,
    simulate_geometry,
    simulate_readings,
)
from gonio.cli.running import Force, Json, out, pairs, print_json, progress_bar
from gonio.instruments import presets
from gonio.materials import MATERIALS
from gonio.simulated_path import PICTURES, write_path_table
from gonio.simulated_path import plot_path as draw_path
from gonio.simulating import INSTRUMENT


class Hemisphere(StrEnum):
    """Names of `--component`."""

    REFLECTION = "reflection"
    TRANSMISSION = "transmission"


COMPONENTS: dict[Hemisphere, Literal["reflection", "transmission"]] = {
    Hemisphere.REFLECTION: "reflection",
    Hemisphere.TRANSMISSION: "transmission",
}


def simulate(
    to: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="Directory of the raw files; XML file of geometry."),
    ] = None,
    material: Annotated[str, typer.Option(help=f"{', '.join(MATERIALS)}, or a file of a model.")] = "plastic",
    seed: Annotated[int, typer.Option(help="Seed of path, noise and drift.")] = 1,
    incidence: Annotated[
        list[str] | None,
        typer.Option(
            metavar="THETA,PHI",
            help="Incidence in degrees; above 90 the back is lit, which scatters as the front; repeat it.",
        ),
    ] = None,
    component: Annotated[
        list[Hemisphere] | None,
        typer.Option(help="reflection or transmission; repeat it."),
    ] = None,
    instrument: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FILE|PRESET|NAME=NUMBER",
            help="Instrument: a TOML file or one of --list-instruments; or a setting that replaces its own, "
            f"angles in degrees, lengths in metres: {', '.join(INSTRUMENT)}; repeat it.",
        ),
    ] = None,
    path_table: Annotated[
        Path | None, typer.Option("--path-table", help="Where the detector read, as a table.")
    ] = None,
    plot_path: Annotated[
        Path | None, typer.Option("--plot-path", help="The same drawn: .png, .svg, .pdf.")
    ] = None,
    list_instruments: Annotated[
        bool, typer.Option("--list-instruments", help="List the instruments that come with gonio.")
    ] = False,
    geometry: Geometry = None,
    window: Window = None,
    periodic: Periodic = False,
    unit: Unit = 1.0,
    basis: Basis = "full",
    levels: Levels = 5,
    tolerance: Tolerance = 0.01,
    error: Error = 0.05,
    rays: Rays = None,
    joined: Joined = 2**14,
    force: Force = False,
    json: Json = False,
) -> None:
    """Measure a material or geometry with the virtual goniophotometer: raw files. BSDF of geometry: XML."""
    if list_instruments:
        _list(json)
        return
    if to is None:
        raise typer.BadParameter("missing, allowed a directory", param_hint="-o")
    if geometry and to.suffix.lower() == ".xml":
        simulate_geometry(
            geometry,
            to,
            window=window,
            periodic=periodic,
            basis=basis,
            levels=levels,
            tolerance=tolerance,
            error=error,
            rays=rays,
            seed=seed,
            json=json,
        )
        return
    given = instrument or []
    described = [text for text in given if "=" not in text]
    if len(described) > 1:
        raise typer.BadParameter(f"found {', '.join(described)}, allowed one", param_hint="--instrument")
    settings = {
        name: number_of(value, "--instrument")
        for name, value in pairs([t for t in given if "=" in t], option="--instrument").items()
    }
    if geometry:
        simulate_readings(
            geometry,
            to,
            window=window,
            periodic=periodic,
            unit=unit,
            seed=seed,
            incidences=[incidence_of(text) for text in incidence] if incidence else None,
            components=[COMPONENTS[c] for c in component] if component else None,
            joined=joined,
            instrument=described[0] if described else None,
            settings=settings,
            force=force,
            json=json,
        )
        return
    if plot_path is not None and plot_path.suffix.lower() not in PICTURES:
        raise typer.BadParameter(
            f"found {plot_path}, allowed {', '.join(PICTURES)}", param_hint="--plot-path"
        )
    with progress_bar(hidden=json) as progress:
        campaign = gonio.simulate(
            out=to,
            material=material,
            seed=seed,
            incidences=[incidence_of(text) for text in incidence] if incidence else None,
            components=[COMPONENTS[c] for c in component] if component else None,
            instrument=described[0] if described else None,
            settings=settings,
            force=force,
            progress=progress,
        )
    if path_table is not None:
        write_path_table(campaign.path, out=path_table)
    if plot_path is not None:
        draw_path(campaign.path, out=plot_path)
    if json:
        print_json(
            {
                "out": campaign.out,
                "material": campaign.material.name,
                "seed": campaign.seed,
                "readings": campaign.readings,
                "sample": campaign.sample,
                "beam": campaign.beam,
                "dark": campaign.dark,
            }
        )
        return
    out.print(f"{campaign.out}: {campaign.readings} readings of {campaign.material.name}")
    for path in (*campaign.sample, *campaign.beam, *campaign.dark):
        out.print(f"  {path}")


def _list(json: bool) -> None:
    found = presets()
    if json:
        print_json({"instruments": found})
        return
    for name, about in found.items():
        out.print(f"{name:14} {about}")


def number_of(text: str, option: str) -> float:
    """The number that an option gives."""
    try:
        return float(text)
    except ValueError:
        raise typer.BadParameter(f"found {text!r}, allowed a number", param_hint=option) from None


def incidence_of(text: str) -> tuple[float, float]:
    """The angles that `--incidence` gives."""
    parts = text.split(",")
    if len(parts) != 2:
        raise typer.BadParameter(f"found {text!r}, allowed THETA,PHI", param_hint="--incidence")
    return number_of(parts[0], "--incidence"), number_of(parts[1], "--incidence")
