"""`gonio inspect`: what is in these files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.reading import Channel, Columns, Format, Quantity, column_map
from gonio.cli.running import Json, err, out, print_json
from gonio.inspecting import FileSummary, RecordSummary


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
    out.print(f"{file.path} ({file.format}, {len(file.records)} records)", style="bold")
    rows = [_row(record) for record in file.records]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        line = "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True))
        out.print(f"  {line.rstrip()}")


def _row(r: RecordSummary) -> list[str]:
    return [
        f"{r.kind} {r.quantity}",
        r.channel,
        f"theta_i {r.theta_i:.4g}",
        f"phi_i {r.phi_i:.4g}",
        f"{r.readings} readings",
        "" if r.theta_s_min is None else f"theta_s {r.theta_s_min:.4g} to {r.theta_s_max:.4g}",
        "" if r.value_min is None else f"{r.quantity} {r.value_min:.4g} to {r.value_max:.4g}",
        "; ".join(r.notes),
    ]
