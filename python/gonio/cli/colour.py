"""`gonio colour`: spectra to photopic value and Radiance RGB."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Json, out, print_json, warn
from gonio.colours import ILLUMINANTS


def colour(
    spectra: Annotated[Path, typer.Argument(help="Text file: wavelength, then one or more spectra.")],
    column: Annotated[
        list[str] | None,
        typer.Option(help="Name or number (the wavelength is 1) of a column; repeat it. All without it."),
    ] = None,
    illuminant: Annotated[str, typer.Option(help=f"{', '.join(ILLUMINANTS)}.")] = "D65",
    percent: Annotated[
        bool | None, typer.Option("--percent/--no-percent", help="Whether the values are percent.")
    ] = None,
    wavelength_unit: Annotated[
        str | None, typer.Option(help="nm or um, where the file does not state it.")
    ] = None,
    json: Json = False,
) -> None:
    """Photopic value and Radiance RGB of reflectance or transmittance spectra."""
    found = gonio.colour(
        spectra,
        columns=column or [],
        illuminant=illuminant,
        percent=percent,
        wavelength_unit=wavelength_unit,
    )
    if json:
        print_json({"illuminant": illuminant, "colours": [c.to_dict() for c in found]})
        return
    width = max(len(c.name) for c in found)
    for c in found:
        warn(c.warnings)
        red, green, blue = c.rgb
        out.print(f"{c.name:<{width}}  photopic {c.photopic:.4f} ({illuminant})  ", end="")
        out.print(f"RGB {red:.4f} {green:.4f} {blue:.4f}", style="bold")
