"""`gonio sphere`: a virtual integrating sphere with a gloss trap."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Json, out, print_json, progress_bar, warn
from gonio.materials import MATERIALS
from gonio.spheres import METHODS, spheres


def sphere(
    sample: Annotated[
        str | None,
        typer.Argument(
            help=f"{', '.join(MATERIALS)}, a file of a model, or a directory of gonio process or gonio fit."
        ),
    ] = None,
    instrument: Annotated[
        str, typer.Option("--sphere", metavar="FILE|PRESET", help="A TOML file, or one of --list-spheres.")
    ] = "reflectance-300",
    theta_i: Annotated[
        float | None, typer.Option("--theta-i", help="Angle of incidence in degrees; the sphere's without.")
    ] = None,
    phi_i: Annotated[float, typer.Option("--phi-i", help="Azimuth of incidence, degrees.")] = 0.0,
    channel: Annotated[str | None, typer.Option("--channel", help="Channel of the model.")] = None,
    method: Annotated[str | None, typer.Option(help=f"{', '.join(METHODS)}; the sphere's without.")] = None,
    error: Annotated[float, typer.Option(help="Standard error of the rays in reflectance.")] = 5e-4,
    rays: Annotated[int | None, typer.Option(help="Rays of each reading, in place of --error.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of the rays.")] = 1,
    integrate: Annotated[
        bool,
        typer.Option(
            "--integrate", help="Integrate a measurement over the cone of --port; no sphere is simulated."
        ),
    ] = False,
    port: Annotated[
        float, typer.Option(help="With --integrate: half the angle the port subtends, degrees.")
    ] = 5.0,
    component: Annotated[
        str, typer.Option("--component", help="With --integrate: reflection or transmission.")
    ] = "reflection",
    readings: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="TOML file of what was read, for gonio fit --sphere."),
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Drawing of the sphere: .png, .svg, .pdf.")] = None,
    list_spheres: Annotated[
        bool, typer.Option("--list-spheres", help="List the spheres that come with gonio.")
    ] = False,
    json: Json = False,
) -> None:
    """Total and diffuse reflectance and specularity in a virtual integrating sphere (DIN 5036-3)."""
    if list_spheres:
        found = spheres()
        if json:
            print_json({"spheres": found})
            return
        for name, about in found.items():
            out.print(f"{name:18} {about}")
        return
    if plot is not None:
        gonio.draw_sphere(instrument, out=plot, theta_i=theta_i)
    if sample is None:
        if plot is None:
            raise typer.BadParameter("missing, allowed a material or its file", param_hint="SAMPLE")
        return
    if integrate:
        _integrate(sample, port, theta_i, phi_i, channel, component, readings, json=json)
        return
    with progress_bar(hidden=json) as progress:
        measured = gonio.sphere(
            sample,
            sphere=instrument,
            theta_i=theta_i,
            phi_i=phi_i,
            channel=channel,
            method=method,
            error=error,
            rays=rays,
            seed=seed,
            progress=progress,
        )
    if readings is not None:
        measured.write(readings)
    if json:
        print_json(measured.to_dict())
        return
    warn(measured.warnings)
    _print(measured)


def _print(m: gonio.SphereMeasurement) -> None:
    word = "reflectance" if m.arrangement == "reflection" else "transmittance"
    out.print(
        f"{m.sphere}: {word} at {m.theta_i:g} degrees, {m.channel}, {m.method}, {m.rays} rays", style="bold"
    )
    out.print(f"  {'':24} {'sphere':>9} {'u':>9} {'model':>9}")
    rows = [("total", m.total, m.model_total)]
    if m.port is not None and m.diffuse is not None and m.model_port is not None:
        rows += [
            ("diffuse (trap open)", m.diffuse, m.model_total - m.model_port),
            ("through the trap", m.port, m.model_port),
        ]
    for name, value, model in rows:
        out.print(f"  {name:24} {value.value:9.5f} {value.u:9.5f} {model:9.5f}")
    if m.specularity is not None and m.diffuse_share is not None and m.half_angle is not None:
        model = ((m.model_port or 0.0) - m.diffuse_share * m.model_total) / (1.0 - m.diffuse_share)
        value = m.specularity
        out.print(f"  {'specularity':24} {value.value:9.5f} {value.u:9.5f} {model:9.5f}")
        out.print(
            f"  cone of the trap: {m.half_angle:.4g} degrees, {100 * m.diffuse_share:.3g} % of diffuse light"
        )
    out.print(f"  bare ratios of readings: total {m.plain_total.value:.5f}", end="")
    plain = "" if m.plain_specularity is None else f", specularity {m.plain_specularity.value:.5f}"
    out.print(f"{plain}; substitution error {m.substitution_error:+.5f}")


def _integrate(
    sample: str,
    port: float,
    theta_i: float | None,
    phi_i: float,
    channel: str | None,
    component: str,
    readings: Path | None,
    *,
    json: bool,
) -> None:
    found = gonio.sphere_integrals(
        sample,
        half_angle=port,
        theta_i=8.0 if theta_i is None else theta_i,
        phi_i=phi_i or None,
        channel=channel,
        component=component,
    )
    if readings is not None:
        found.readings_to_fit.write(readings)
    if json:
        print_json(found.to_dict())
        return
    warn(found.warnings)
    out.print(
        f"{sample}: {found.component} at theta_i {found.theta_i:g}, {found.channel}, "
        f"cone of {port:g} degrees",
        style="bold",
    )
    for name in ("total", "diffuse", "port", "specularity"):
        value = getattr(found, name)
        out.print(f"  {name:12} {value.value:9.5f} ± {2 * value.u:.5f} (k = 2)")
    out.print(
        f"  of the port: readings {found.u_readings:.2g}, common {found.u_common:.2g}, "
        f"quadrature {found.u_quadrature:.2g}; {found.readings} readings in the cone"
    )
