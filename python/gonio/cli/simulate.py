"""`gonio simulate`: raw files of a known material."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

import typer

import gonio
from gonio.cli.running import Force, Json, out, pairs, print_json
from gonio.materials import MATERIALS
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
    to: Annotated[Path, typer.Option("-o", "--out", help="Directory of the raw files.")],
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
            metavar="NAME=NUMBER",
            help=f"Setting of the virtual instrument, angles in degrees: {', '.join(INSTRUMENT)}; repeat it.",
        ),
    ] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Measure a known material with the virtual goniophotometer and write its raw files."""
    settings = {
        name: _number(value, "--instrument")
        for name, value in pairs(instrument or [], option="--instrument").items()
    }
    campaign = gonio.simulate(
        out=to,
        material=material,
        seed=seed,
        incidences=[_incidence(text) for text in incidence] if incidence else None,
        components=[COMPONENTS[c] for c in component] if component else None,
        instrument=settings,
        force=force,
    )
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


def _number(text: str, option: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise typer.BadParameter(f"found {text!r}, allowed a number", param_hint=option) from None


def _incidence(text: str) -> tuple[float, float]:
    parts = text.split(",")
    if len(parts) != 2:
        raise typer.BadParameter(f"found {text!r}, allowed THETA,PHI", param_hint="--incidence")
    return _number(parts[0], "--incidence"), _number(parts[1], "--incidence")
