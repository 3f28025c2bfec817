"""`gonio report`: one HTML file that opens offline."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Json, out, print_json, progress_bar


def report(
    measurement: Annotated[Path, typer.Argument(help="Directory written by gonio process.")],
    to: Annotated[
        Path | None, typer.Option("-o", "--out", help="HTML file. Without it report.html in the directory.")
    ] = None,
    title: Annotated[str | None, typer.Option(help="Heading. Without it the name of the sample.")] = None,
    json: Json = False,
) -> None:
    """Write the report of a measurement as one HTML file."""
    target = measurement / "report.html" if to is None else to
    with progress_bar(hidden=json) as progress:
        path = gonio.report(measurement, out=target, title=title, progress=progress)
    if json:
        print_json({"out": path, "bytes": path.stat().st_size})
    else:
        out.print(f"{path}")
