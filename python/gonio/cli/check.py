"""`gonio check`: verdicts on a measurement or a model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio import QuantityError
from gonio.cli.running import Json, out, print_json
from gonio.model_files import is_model

STYLES = {"pass": "green", "info": "dim", "warn": "yellow", "fail": "bold red"}
EXIT_FAILED = 1


def check(
    measurement: Annotated[
        Path, typer.Argument(help="Directory written by gonio process, or the file of a model.")
    ],
    repeat: Annotated[
        list[Path] | None, typer.Option(help="Another measurement of the same sample; repeat it.")
    ] = None,
    isotropic: Annotated[
        bool | None,
        typer.Option(
            "--isotropic/--anisotropic", help="What the sample is. Without it told from the azimuths."
        ),
    ] = None,
    channel: Annotated[
        str | None, typer.Option("--channel", help="Channel of a BSDF XML that has several.")
    ] = None,
    json: Json = False,
) -> None:
    """Check a measurement or a model; exit code 1 when a check fails."""
    if measurement.is_file() and is_model(measurement):
        if repeat or isotropic is not None:
            raise QuantityError(
                f"{measurement}: found a model, needed a measurement for --repeat and --isotropic"
            )
        verdicts = gonio.check_model(gonio.read_bsdf(measurement, channel=channel))
    else:
        verdicts = gonio.check(measurement, repeats=repeat or [], isotropic=isotropic)
    if json:
        print_json({"verdicts": [v.to_dict() for v in verdicts]})
    else:
        width = max(len(v.title) for v in verdicts)
        for v in verdicts:
            out.print(f"{v.verdict:<4}", style=STYLES[v.verdict], end="  ")
            unit = "" if v.unit == "1" else f" {v.unit}"
            value = "" if v.value is None else f"{v.value:.4g}{unit}: "
            out.print(f"{v.title:<{width}}  {value}{v.sentence}")
    if any(v.verdict == "fail" for v in verdicts):
        raise typer.Exit(EXIT_FAILED)
