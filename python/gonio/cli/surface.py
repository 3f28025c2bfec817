"""`gonio surface`: height maps of rough surfaces as geometry."""

from __future__ import annotations

import shlex
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.roughness import Length, Spacing, steps_of
from gonio.cli.running import Json, out, print_json


class Material(StrEnum):
    """Names of `--material`."""

    MIRROR = "mirror"
    METAL = "metal"
    DIELECTRIC = "dielectric"


def surface(
    heights: Annotated[Path, typer.Argument(metavar="MAP", help="Height map: text, .npy or .sdf.")],
    to: Annotated[Path, typer.Option("-o", "--out", help="Scene, .rad; the mesh is written beside it.")],
    material: Annotated[Material, typer.Option(help="What the surface is made of.")] = Material.MIRROR,
    value: Annotated[
        float | None,
        typer.Option(help="Reflectance of a mirror or metal (1), refractive index of a dielectric (1.5)."),
    ] = None,
    joins: Annotated[
        bool, typer.Option("--joins", help="The map repeats by itself; otherwise it is repeated mirrored.")
    ] = False,
    spacing: Spacing = None,
    x_unit: Length = None,
    z_unit: Length = None,
    json: Json = False,
) -> None:
    """Write a height map as geometry that gonio simulate --geometry measures."""
    found = gonio.surface(
        heights,
        out=to,
        material=material.value,
        value=value,
        joins=joins,
        spacing=steps_of(spacing),
        x_unit=x_unit,
        z_unit=z_unit,
    )
    if json:
        print_json(
            {
                "out": found.scene,
                "mesh": found.mesh,
                "window": found.window,
                "unit": found.unit,
                "rms_slope": found.rms_slope,
            }
        )
        return
    width, height = found.window[2:]
    out.print(f"{found.scene}: period {width:.6g} x {height:.6g} um, RMS slope {found.rms_slope:.4f}")
    out.print(f"  {found.mesh}")
    measure = f"gonio simulate --geometry {shlex.quote(str(found.scene))} --periodic"
    measure += f" --window {','.join(repr(x) for x in found.window)}"
    out.print(f"BSDF:     {measure} -o {shlex.quote(str(found.scene.with_suffix('.xml')))}")
    out.print(f"readings: {measure} --unit {found.unit:g} -o scan/")
