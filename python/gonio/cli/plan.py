"""`gonio plan`: the path for target uncertainties."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Force, Json, out, pairs, print_json, progress_bar
from gonio.cli.simulate import COMPONENTS, Hemisphere, incidence_of, number_of
from gonio.materials import MATERIALS


def plan(
    known: Annotated[
        str,
        typer.Argument(
            help=f"What is known of the material: {', '.join(MATERIALS)}, a file of a model, a directory of "
            "a measurement, or one of raw files of a fast scan."
        ),
    ],
    to: Annotated[
        Path | None, typer.Option("-o", "--out", help="Directory of instrument.toml, path.csv, path.png.")
    ] = None,
    target_dhr: Annotated[
        float, typer.Option(help="Relative standard uncertainty of every DHR and DHT.")
    ] = 0.005,
    target_peak: Annotated[
        float, typer.Option(help="Relative standard uncertainty of the highest reading of every hemisphere.")
    ] = 0.01,
    minutes: Annotated[
        float | None, typer.Option(help="Time of the campaign, dark records and scans of the beam included.")
    ] = None,
    instrument: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FILE|PRESET|NAME=NUMBER",
            help="Instrument as of gonio simulate, pgII-like without; or a setting that replaces its own; "
            "repeat it.",
        ),
    ] = None,
    incidence: Annotated[
        list[str] | None, typer.Option(metavar="THETA,PHI", help="Incidence in degrees; repeat it.")
    ] = None,
    component: Annotated[
        list[Hemisphere] | None, typer.Option(help="reflection or transmission; repeat it.")
    ] = None,
    largest_pitch: Annotated[
        float, typer.Option(help="Largest pitch in degrees: what is not known is found if it is wider.")
    ] = 10.0,
    region: Annotated[
        list[str] | None,
        typer.Option(
            metavar="THETA,PHI,RADIUS,PITCH", help="Region in degrees that is read in any case; repeat it."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the phases of the path.")] = 1,
    force: Force = False,
    json: Json = False,
) -> None:
    """Plan the path that measures DHR and peak to target uncertainties, and say what it will miss."""
    given = instrument or []
    described = [text for text in given if "=" not in text]
    if len(described) > 1:
        raise typer.BadParameter(f"found {', '.join(described)}, allowed one", param_hint="--instrument")
    settings = {
        name: number_of(value, "--instrument")
        for name, value in pairs([t for t in given if "=" in t], option="--instrument").items()
    }
    with progress_bar(hidden=json) as progress:
        found = gonio.plan(
            known,
            instrument=described[0] if described else "pgII-like",
            settings=settings,
            incidences=[incidence_of(text) for text in incidence] if incidence else None,
            components=[COMPONENTS[c] for c in component] if component else None,
            target_dhr=target_dhr,
            target_peak=target_peak,
            minutes=minutes,
            largest_pitch=largest_pitch,
            regions=[_region(text) for text in region or []],
            seed=seed,
            out=to,
            force=force,
            progress=progress,
        )
    if json:
        print_json({"out": to, **found.to_dict()})
        return
    out.print(f"{found.material.name}: {found.material.description}")
    out.print(
        f"{found.readings:,} readings, {found.seconds / 60:.1f} minutes with {found.instrument.name}; "
        f"targets {'met' if found.met else 'NOT met'}"
    )
    several = len(found.channels) > 1
    head = "theta_i   phi_i  hemisphere    readings  minutes  integral    u, %       peak    u, %"
    out.print(head + ("  decided by" if several else ""))
    for s in found.scans:
        by = f"  {s.channel_integral}, {s.channel_peak}" if several else ""
        out.print(
            f"{s.theta_i:7.1f} {s.phi_i:7.1f}  {s.component:12} {s.readings:9,} {s.seconds / 60:8.1f} "
            f"{s.integral:9.4f} {100 * max(s.u_integral, s.error):7.2f} {s.peak:10.4g} {100 * s.u_peak:7.2f}"
            f"{by}"
        )
    for sentence in found.misses:
        out.print(f"- {sentence}")
    if to is not None:
        out.print(f"{to}: {_next(known, found, to)}", soft_wrap=True)


def _next(known: str, found: gonio.Plan, to: Path) -> str:
    """The command that simulates the planned scans; of a measurement, the user has the model."""
    material = "MODEL" if Path(known).is_dir() else known
    places = dict.fromkeys(f"{s.theta_i:g},{s.phi_i:g}" for s in found.scans)
    words = ["gonio simulate --material", shlex.quote(material), "--instrument"]
    words.append(shlex.quote(str(to / "instrument.toml")))
    words += [f"--incidence {place}" for place in places]
    return " ".join([*words, "-o scan/"])


def _region(text: str) -> tuple[float, float, float, float]:
    parts = text.split(",")
    if len(parts) != 4:
        raise typer.BadParameter(f"found {text!r}, allowed THETA,PHI,RADIUS,PITCH", param_hint="--region")
    theta, phi, radius, pitch = (number_of(p, "--region") for p in parts)
    return theta, phi, radius, pitch
