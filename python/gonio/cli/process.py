"""`gonio process`: from raw readings to a measurement."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.reading import Channel, Columns, Format, Quantity, UpPhi, column_map
from gonio.cli.running import Force, Json, out, print_json, progress_bar, warn
from gonio.files import check_file


def process(
    files: Annotated[list[Path], typer.Argument(help="Readings of the sample.")],
    to: Annotated[Path, typer.Option("-o", "--out", help="Directory of the measurement.")],
    beam: Annotated[list[Path] | None, typer.Option(help="Reference scan of the beam; repeat it.")] = None,
    dark: Annotated[list[Path] | None, typer.Option(help="Dark or blank scan; repeat it.")] = None,
    standard: Annotated[
        list[Path] | None, typer.Option(help="Scan of a calibrated standard, in place of --beam.")
    ] = None,
    standard_reflectance: Annotated[
        float | None, typer.Option(help="Reflectance factor of the standard.")
    ] = None,
    u_standard: Annotated[float, typer.Option(help="Its relative standard uncertainty.")] = 0.0,
    align: Annotated[bool, typer.Option("--align", help="Correct the sample's tilt and azimuth.")] = False,
    format: Format = None,
    column: Columns = None,
    quantity: Quantity = None,
    channel: Channel = None,
    upphi: UpPhi = None,
    dark_method: Annotated[str, typer.Option(help="auto, direction, time or level.")] = "auto",
    dark_tolerance: Annotated[float, typer.Option(help="Degrees between reading and blank.")] = 0.25,
    noise_readout: Annotated[float | None, typer.Option(help="Read-out noise, unit of the readings.")] = None,
    noise_relative: Annotated[float | None, typer.Option(help="Noise as a fraction of the signal.")] = None,
    u_angle: Annotated[float, typer.Option(help="Standard uncertainty of a direction, degrees.")] = 0.0,
    u_calibration: Annotated[float, typer.Option(help="Relative standard uncertainty of all values.")] = 0.0,
    shadow_radius: Annotated[
        float | None,
        typer.Option(
            help="Detector shadow about the retro direction, degrees. Without it receiver and beam tell, "
            "where they are known."
        ),
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the sample. Without it the files'.")] = None,
    netcdf: Annotated[Path | None, typer.Option(help="Write a netCDF file, too.")] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Process raw readings to DSF and BSDF with their uncertainty."""
    if netcdf is not None and netcdf.absolute().parent != to.absolute():
        check_file(netcdf)
    with progress_bar(hidden=json) as progress:
        measurement = gonio.process(
            files,
            beam=beam,
            dark=dark,
            standard=standard,
            standard_reflectance=standard_reflectance,
            u_standard=u_standard,
            align=align,
            format=format,
            columns=column_map(column),
            quantity=quantity,
            channel=channel,
            upphi=upphi,
            dark_method=dark_method,
            dark_tolerance=dark_tolerance,
            noise_readout=noise_readout,
            noise_relative=noise_relative,
            u_angle=u_angle,
            u_calibration=u_calibration,
            shadow_radius=shadow_radius,
            name=name,
            out=to,
            force=force,
            progress=progress,
        )
        if netcdf is not None:
            measurement.to_netcdf(netcdf)
    warn(measurement.warnings)
    if json:
        print_json({"out": to, **measurement.summary()})
        return
    out.print(f"{to}: {measurement}")
    tilt = measurement.provenance["processing"]["alignment"]
    if tilt is not None:
        out.print(f"  {_alignment(tilt, corrected=align)}")
    for s in measurement.slices:
        place = f"  {s.channel}  theta_i {s.theta_i:.4g}  phi_i {s.phi_i:.4g}"
        if not s.integrals:
            out.print(f"{place}  no DHR or DHT: the usable readings cover less than a tenth of a hemisphere")
        for i in s.integrals:
            name = "DHR" if (s.theta_i <= 90) == (i.side == "front") else "DHT"
            share = 100 * i.extrapolated / i.value if i.value else 0.0
            out.print(
                f"{place}  {name} {i.value:.4f} ± {2 * i.u:.4f} (k = 2), {share:.1f} % of it extrapolated"
            )


def _alignment(found: dict[str, float], *, corrected: bool) -> str:
    """How the sample stood, and what was done about it."""
    if not found["significant"]:
        done = "within their uncertainty: not corrected"
    else:
        done = "corrected" if corrected else "not corrected: --align does"
    parts = [
        f"{name} {found[key]:.3f} ± {2 * found[f'u_{key}']:.3f} deg"
        for name, key in (
            ("tilt about x", "tilt_x"),
            ("about y", "tilt_y"),
            ("azimuth offset", "azimuth"),
        )
    ]
    return f"{', '.join(parts)} (k = 2; {done})"
