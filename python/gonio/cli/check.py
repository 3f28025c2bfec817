"""`gonio check`: verdicts on a measurement."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Json, out, print_json

STYLES = {"pass": "green", "info": "dim", "warn": "yellow", "fail": "bold red"}
EXIT_FAILED = 1


def check(
    measurement: Annotated[Path, typer.Argument(help="Directory written by gonio process.")],
    repeat: Annotated[
        list[Path] | None, typer.Option(help="Another measurement of the same sample; repeat it.")
    ] = None,
    isotropic: Annotated[
        bool | None,
        typer.Option(
            "--isotropic/--anisotropic", help="What the sample is. Without it told from the azimuths."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Check a measurement; exit code 1 when a check fails."""
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
