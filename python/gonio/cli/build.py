"""`gonio build`: a data-driven model and its errors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Json, out, print_json, progress_bar, warn

Channel = Annotated[str | None, typer.Option("--channel", help="The channel; the only one there is.")]
Symmetry = Annotated[str, typer.Option("--symmetry", help="auto, isotropic or anisotropic.")]


def build(
    measurement: Annotated[Path, typer.Argument(help="Directory written by gonio process.")],
    channel: Channel = None,
    symmetry: Symmetry = "auto",
    smooth: Annotated[bool, typer.Option(help="Smooth readings within their stated noise.")] = True,
    candidate: Annotated[str | None, typer.Option(help="Interpolation over incidence; chosen.")] = None,
    json: Json = False,
) -> None:
    """Build a data-driven model and show how well it predicts incidences it was not given.

    gonio export builds the same model and writes it as a file.
    """
    with progress_bar(hidden=json) as progress:
        model = gonio.build(
            measurement,
            channel=channel,
            symmetry=symmetry,
            smooth=smooth,
            candidate=candidate,
            progress=progress,
        )
    warn(model.warnings)
    if json:
        print_json(
            {
                "channels": model.channels,
                "properties": model.properties,
                "loo_error": model.loo_error,
                "loo": model.loo,
                "summary": model.summary,
                "warnings": model.warnings,
            }
        )
        return
    for part in model.summary:
        out.print(
            f"{part['side']} {part['component']}: {part['incidences']} incidences, "
            f"{part['readings']} readings, interpolated by {part['candidate']}"
        )
    for row in model.loo:
        out.print(
            f"  {row['component']} at theta_i {row['theta_i']:.4g}, phi_i {row['phi_i']:.4g} "
            f"predicted from the others: {100 * row['rel_rms']:.2f} % rms"
        )
