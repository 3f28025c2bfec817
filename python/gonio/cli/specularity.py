"""`gonio specularity`: readings of an integrating sphere with a gloss trap."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

import typer

import gonio
from gonio.cli.running import Json, out, print_json, warn


class Material(StrEnum):
    """Names of `--material`."""

    PLASTIC = "plastic"
    METAL = "metal"


MATERIALS: dict[Material, Literal["plastic", "metal"]] = {
    Material.PLASTIC: "plastic",
    Material.METAL: "metal",
}


def specularity(
    total: Annotated[float, typer.Option(help="Reflectance with the port closed, 0 to 1.")],
    diffuse: Annotated[float, typer.Option(help="Reflectance with the port (gloss trap) open, 0 to 1.")],
    port: Annotated[float, typer.Option(help="Half the angle the port subtends at the sample, degrees.")],
    u_total: Annotated[float, typer.Option(help="Standard uncertainty of --total.")] = 0.0,
    u_diffuse: Annotated[float, typer.Option(help="Standard uncertainty of --diffuse.")] = 0.0,
    correlation: Annotated[float, typer.Option(help="Correlation of the two readings, -1 to 1.")] = 0.0,
    u_port: Annotated[float, typer.Option(help="Standard uncertainty of --port, degrees.")] = 0.0,
    theta_i: Annotated[float, typer.Option(help="Angle of incidence, degrees.")] = 8.0,
    alpha: Annotated[float | None, typer.Option(help="Width of the lobe, where it is known.")] = None,
    u_alpha: Annotated[float, typer.Option(help="Standard uncertainty of --alpha.")] = 0.0,
    plug: Annotated[float, typer.Option(help="Reflectance of the port's plug over that of the wall.")] = 1.0,
    u_plug: Annotated[float, typer.Option(help="Standard uncertainty of --plug.")] = 0.0,
    rgb: Annotated[
        str | None,
        typer.Option(
            metavar="R,G,B", help="Colour at any scale; gives the parameters of a Radiance material."
        ),
    ] = None,
    material: Annotated[Material, typer.Option(help="plastic or metal.")] = Material.PLASTIC,
    target: Annotated[
        Path | None, typer.Option("-o", "--out", help="File of the Radiance material (.rad); takes --rgb.")
    ] = None,
    name: Annotated[str, typer.Option(help="Name of the material in it.")] = "material",
    json: Json = False,
) -> None:
    """Specularity from the total and the diffuse reflectance of an integrating sphere."""
    if target is not None and rgb is None:
        raise typer.BadParameter("a Radiance material takes a colour: give --rgb", param_hint="--out")
    found = gonio.specularity(
        rho_total=total,
        rho_diffuse=diffuse,
        u_rho_total=u_total,
        u_rho_diffuse=u_diffuse,
        correlation=correlation,
        port_half_angle=port,
        u_port_half_angle=u_port,
        theta_i=theta_i,
        alpha=alpha,
        u_alpha=u_alpha,
        plug=plug,
        u_plug=u_plug,
        rgb=None if rgb is None else _three(rgb),
        material=MATERIALS[material],
    )
    if target is not None and found.radiance is not None:
        comment = f"gonio specularity: {_stated(found.specularity, found.u, sign='+-')}"
        gonio.write_materials(target, found.radiance.to_material(name), comment=comment)
    if json:
        print_json(found.to_dict())
        return
    warn(found.warnings)
    out.print(f"specularity         {_stated(found.specularity, found.u)}", style="bold")
    out.print(f"  diffuse           {_stated(found.rho_diffuse, found.u_rho_diffuse)}")
    out.print(f"  lobe              {found.rho_lobe:.4f} at theta_i {found.theta_i:g}")
    out.print(f"  total             {found.rho_total:.4f}")
    out.print(f"  through the port  {100 * found.lobe_in_port:.1f} % of the lobe, ", end="")
    out.print(f"{100 * found.diffuse_in_port:.2f} % of diffuse light")
    for i in found.inputs:
        if i.u > 0.0:
            out.print(f"  u({i.name}) {i.u:.3g}: sensitivity {i.sensitivity:.3g}, adds {i.contribution:.2g}")
    if found.u > 0.0:
        correlated = f", correlation {correlation:g} of the two readings" if correlation else ""
        out.print(f"  u(specularity) {found.u:.2g}, all of them combined (k = 1){correlated}")
    if found.radiance is not None:
        p = found.radiance
        if max(p.red, p.green, p.blue) > 1.0:
            # The warning says so.
            return
        colour = f"{p.red:.4f} {p.green:.4f} {p.blue:.4f}"
        out.print(f"  {p.material}  5  {colour}  {p.specularity:.4f} {p.roughness:.4g}")


def _stated(value: float, u: float, *, sign: str = "±") -> str:
    """The value with its expanded uncertainty, if any input states one."""
    return f"{value:.4f} {sign} {2 * u:.4f} (k = 2)" if u > 0.0 else f"{value:.4f} (uncertainty not stated)"


def _three(text: str) -> tuple[float, float, float]:
    try:
        red, green, blue = (float(part) for part in text.split(","))
    except ValueError:
        raise typer.BadParameter(f"found {text!r}, allowed R,G,B", param_hint="--rgb") from None
    return red, green, blue
