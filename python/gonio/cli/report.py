"""`gonio report`: one HTML file that opens offline."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Json, out, print_json, progress_bar
from gonio.fit_outputs import read_fitted_model


def report(
    measurement: Annotated[Path, typer.Argument(help="Directory written by gonio process.")],
    to: Annotated[
        Path | None, typer.Option("-o", "--out", help="HTML file. Without it report.html in the directory.")
    ] = None,
    fit: Annotated[
        Path | None,
        typer.Option("--fit", help="Directory written by gonio fit: its model is drawn over the readings."),
    ] = None,
    title: Annotated[str | None, typer.Option(help="Heading. Without it the name of the sample.")] = None,
    json: Json = False,
) -> None:
    """Write the report of a measurement as one HTML file."""
    target = measurement / "report.html" if to is None else to
    model = None if fit is None else read_fitted_model(fit, measurement=measurement)
    with progress_bar(hidden=json) as progress:
        path = gonio.report(measurement, out=target, model=model, title=title, progress=progress)
    if json:
        print_json({"out": path, "bytes": path.stat().st_size})
    else:
        out.print(f"{path}")
