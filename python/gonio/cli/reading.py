"""Options of every verb that reads files."""

from __future__ import annotations

from typing import Annotated

import typer

from gonio.cli.running import pairs
from gonio.readings import FORMATS

Format = Annotated[
    str | None,
    typer.Option("--format", help=f"{', '.join(FORMATS)}; where the file does not tell it itself."),
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--column", metavar="NAME=COLUMN", help="Column of a generic CSV or Parquet file; repeat it."
    ),
]
Quantity = Annotated[
    str | None,
    typer.Option(
        "--quantity", help="signal, bsdf, dsf or reflectance_factor, where the file does not tell it."
    ),
]
Channel = Annotated[
    str | None,
    typer.Option(
        "--channel",
        help="photopic, red, green, blue or a wavelength such as 532nm, where the file does not tell it.",
    ),
]
UpPhi = Annotated[
    float | None, typer.Option("--upphi", help="Azimuth of the up mark of Mountain files, degrees.")
]


def column_map(columns: list[str] | None) -> dict[str, str] | None:
    """`--column` options as a mapping, None without any."""
    return pairs(columns, option="--column") if columns else None
