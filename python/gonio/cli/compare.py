"""`gonio compare`: two models or measurements side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

import gonio
from gonio.cli.component import Components, components_of
from gonio.cli.running import Json, out, print_json, progress_bar, warn
from gonio.comparing import reciprocity_text

_KIND = "File of a model (BSDF XML, SIR, RGL, MERL, compact) or directory of gonio process"


def compare(
    a: Annotated[Path, typer.Argument(help=f"{_KIND}: what counts as right.")],
    b: Annotated[Path, typer.Argument(help=f"{_KIND}: what is judged.")],
    channel: Annotated[
        str | None,
        typer.Option("--channel", help="Channel of both. Without it all that they have in common."),
    ] = None,
    channel_b: Annotated[
        str | None,
        typer.Option("--channel-b", help="Channel of B, where it has another name than that of A."),
    ] = None,
    component: Components = None,
    incidence: Annotated[
        list[str] | None,
        typer.Option(
            metavar="THETA,PHI", help="Incidence in degrees; repeat it. Without it 0 to 75 degrees."
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", help="Profiles and error maps of every incidence: a PNG, PDF or SVG file."),
    ] = None,
    json: Json = False,
) -> None:
    """Compare two models, files or measurements: errors, DHR, peaks and reciprocity for each incidence.

    A measurement takes part as the model that gonio build makes of it.
    """
    with progress_bar(hidden=json) as progress:
        found = gonio.compare(
            a,
            b,
            channel=channel,
            channel_b=channel_b,
            components=components_of(component),
            incidences=[_incidence(text) for text in incidence] if incidence else None,
            progress=progress,
        )
        if picture is not None:
            gonio.compare_picture(found, out=picture, names=(a.name, b.name), progress=progress)
    warn(found.warnings)
    if json:
        print_json(found.to_dict() | {"picture": picture})
        return
    for (channel_name, side, part), total in found.summary.items():
        quantity = "DHR" if part == "reflection" else "DHT"
        columns = (
            "theta_i",
            "phi_i",
            "rel. L1",
            "rms",
            f"{quantity} a",
            f"{quantity} b",
            "peak b/a",
            "shift",
        )
        table = Table(*columns, title=f"{side} {part}, {channel_name}", title_justify="left", box=None)
        for r in found.rows:
            if (r.channel, r.side, r.component) == (channel_name, side, part):
                table.add_row(
                    f"{r.theta_i:g}",
                    f"{r.phi_i:g}",
                    f"{100 * r.rel_l1:.2f} %",
                    f"{100 * r.rel_rms:.2f} %",
                    f"{r.dhr_a:.4f}",
                    f"{r.dhr_b:.4f}",
                    f"{r.peak_ratio:.3f}",
                    f"{r.peak_shift:.2f}",
                )
        out.print(table)
        out.print(
            f"  mean {100 * total['rel_l1']:.2f} % relative L1, largest {100 * total['rel_l1_max']:.2f} %; "
            f"{quantity} by at most {total['dhr_difference']:+.4f}; "
            f"reciprocity {reciprocity_text(total['reciprocity_a'])} "
            f"and {reciprocity_text(total['reciprocity_b'])}"
        )
        if total["ideal_a"] > 0 or total["ideal_b"] > 0:
            out.print(
                f"  unscattered {total['ideal_a']:.4f} and {total['ideal_b']:.4f} of the light, "
                f"by at most {total['ideal_difference']:+.4f}"
            )
    if picture is not None:
        out.print(f"{picture}")


def _incidence(text: str) -> tuple[float, float]:
    parts = text.split(",")
    try:
        theta, phi = (float(p) for p in parts)
    except ValueError:
        raise typer.BadParameter(f"found {text!r}, allowed THETA,PHI", param_hint="--incidence") from None
    return theta, phi
