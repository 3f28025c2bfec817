"""`gonio roughness`: surface profiles and height maps."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Json, out, print_json, warn
from gonio.surface_files import UNITS

Spacing = Annotated[
    str | None,
    typer.Option(metavar="DX[,DY]", help="Step between points in --x-unit, where the file does not hold it."),
]
Length = Annotated[str | None, typer.Option(help=f"{', '.join(UNITS)}; where the file does not state it.")]


def roughness(
    surface: Annotated[Path, typer.Argument(help="Profile or height map: text, .npy or .sdf.")],
    spacing: Spacing = None,
    x_unit: Length = None,
    z_unit: Length = None,
    lambda_s: Annotated[
        float | None, typer.Option(help="Cutoff wavelength in um below which structure is removed.")
    ] = None,
    lambda_c: Annotated[
        float | None, typer.Option(help="Cutoff wavelength in um above which structure is removed.")
    ] = None,
    level: Annotated[bool, typer.Option("--level/--no-level", help="Remove the line or plane.")] = True,
    blocks: Annotated[
        int | None, typer.Option(help="Blocks along each axis for the uncertainty, 2 to 64.")
    ] = None,
    wavelength: Annotated[float, typer.Option(help="Of the light, nm.")] = 550.0,
    json: Json = False,
) -> None:
    """RMS roughness, RMS slope and alpha of a surface profile or height map."""
    found = gonio.roughness(
        surface,
        spacing=steps_of(spacing),
        x_unit=x_unit,
        z_unit=z_unit,
        lambda_s=lambda_s,
        lambda_c=lambda_c,
        level=level,
        blocks=blocks,
        wavelength=wavelength,
    )
    if json:
        print_json(found.to_dict())
        return
    warn(found.warnings)
    height, slope = ("S_q", "S_dq") if found.kind == "map" else ("R_q", "R_dq")
    out.print(f"alpha    {found.alpha:.4f} ± {2 * found.u_alpha:.4f} (k = 2)", style="bold")
    out.print(f"  {height:<6} {found.rms:.4g} um ± {2 * found.u_rms:.2g}")
    out.print(f"  {slope:<6} {found.rms_slope:.4f} ± {2 * found.u_rms_slope:.4f}")
    out.print(f"  band   {found.shortest:.4g} to {found.longest:.4g} um")
    if found.kind == "map":
        out.print(
            f"  along {found.direction:.0f} deg {found.alpha_x:.4f} ± {2 * found.u_alpha_x:.4f}, "
            f"across {found.alpha_y:.4f} ± {2 * found.u_alpha_y:.4f}"
        )
    else:
        out.print("  of an isotropic surface; across a lay, along the profile only")
    lengths = ", ".join("not reached" if t is None else f"{t:.4g} um" for t in found.correlation_length)
    out.print(f"  correlation length {lengths}")


def steps_of(text: str | None) -> tuple[float, float] | None:
    """The steps that `--spacing` gives."""
    if text is None:
        return None
    try:
        steps = [float(part) for part in text.split(",")]
    except ValueError:
        steps = []
    if len(steps) not in (1, 2):
        raise typer.BadParameter(f"found {text!r}, allowed DX or DX,DY", param_hint="--spacing")
    return steps[0], steps[-1]
