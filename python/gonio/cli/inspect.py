"""`gonio inspect`: what is in these files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.table import Table

import gonio
from gonio.cli.reading import Channel, Columns, Format, Quantity, column_map
from gonio.cli.running import Json, err, out, print_json
from gonio.inspecting import FileSummary


def inspect(
    files: Annotated[list[Path], typer.Argument(help="Reading files, measurement directories, models.")],
    format: Format = None,
    column: Columns = None,
    quantity: Quantity = None,
    channel: Channel = None,
    json: Json = False,
) -> None:
    """Show what is in files: format, records, incidences, channels, ranges, problems."""
    found = gonio.inspect(
        files, format=format, columns=column_map(column), quantity=quantity, channel=channel
    )
    if json:
        print_json(found.to_dict())
        return
    for file in found.files:
        _show(file)
    for problem in found.problems:
        err.print(f"gonio: note: {problem}")


def _show(file: FileSummary) -> None:
    table = Table(
        title=f"{file.path}  ({file.format})", box=box.SIMPLE_HEAD, title_justify="left", title_style="bold"
    )
    for heading in ("record", "channel", "theta_i, phi_i", "readings", "theta_s", "value", "notes"):
        table.add_column(heading, no_wrap=heading != "notes")
    for r in file.records:
        theta = "" if r.theta_s_min is None else f"{r.theta_s_min:.4g} … {r.theta_s_max:.4g}"
        value = "" if r.value_min is None else f"{r.value_min:.4g} … {r.value_max:.4g}"
        table.add_row(
            f"{r.kind} {r.quantity}",
            r.channel,
            f"{r.theta_i:.4g}, {r.phi_i:.4g}",
            str(r.readings),
            theta,
            value,
            "; ".join(r.notes),
        )
    out.print(table)
