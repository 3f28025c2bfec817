"""`gonio export`: files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.build import Candidate, Channel, Smooth, Symmetry
from gonio.cli.component import Components, components_of
from gonio.cli.running import Force, Json, out, print_json, progress_bar, warn
from gonio.comparing import reciprocity_text


def export(
    measurement: Annotated[
        Path, typer.Argument(help="Directory written by gonio process, or a file of a model.")
    ],
    to: Annotated[
        str,
        typer.Option(
            "--to",
            help="radiance-klems, radiance-ttree, rgl-bsdf, merl, zemax-bsdf, csv, parquet, netcdf, "
            "bird-json or mountain.",
        ),
    ],
    target: Annotated[Path, typer.Option("-o", "--out", help="File; a directory for mountain.")],
    channel: Channel = None,
    symmetry: Symmetry = "auto",
    smooth: Smooth = True,
    candidate: Candidate = None,
    component: Components = None,
    basis: Annotated[str, typer.Option(help="Klems patches: full, half or quarter.")] = "full",
    cap_albedo: Annotated[
        bool, typer.Option("--cap-albedo", help="Scale Klems patches of albedo above 1 to 1.")
    ] = False,
    rank: Annotated[
        int | None, typer.Option(help="Tensor tree: 3 or 4. Without it what the model needs.")
    ] = None,
    max_depth: Annotated[
        int | None, typer.Option(help="Tensor tree: finest cells of side 2**-depth; 8 unless given.")
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(help="Tensor tree: relative L1 error to stop at; 0.03 unless this or bytes are given."),
    ] = None,
    max_bytes: Annotated[
        int | None,
        typer.Option("--max-bytes", help="Tensor tree: bytes of the data of a component to stop at."),
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the material. Without it the sample's.")] = None,
    manufacturer: Annotated[str, typer.Option(help="Its manufacturer.")] = "",
    thickness: Annotated[float | None, typer.Option(help="Its thickness, metres.")] = None,
    as_visible: Annotated[
        bool, typer.Option("--as-visible", help="Label a single wavelength Visible for Radiance.")
    ] = False,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write a measurement, or the model built from it, in the format of another program.

    The radiance formats, rgl-bsdf, merl and zemax-bsdf build the model of gonio build first, which takes at
    least two incidences, and take a model from a file as well; csv, parquet, netcdf, bird-json and mountain
    hold the readings.
    """
    with progress_bar(hidden=json) as progress:
        written = gonio.export(
            measurement,
            to=to,
            out=target,
            channel=channel,
            symmetry=symmetry,
            smooth=smooth,
            candidate=candidate,
            components=components_of(component),
            basis=basis,
            cap_albedo=cap_albedo,
            rank=rank,
            max_depth=max_depth,
            target=tolerance,
            max_bytes=max_bytes,
            name=name,
            manufacturer=manufacturer,
            thickness=thickness,
            as_visible=as_visible,
            force=force,
            progress=progress,
        )
    warn(written.warnings)
    if json:
        report = _texts(written.report)
        print_json({"to": written.to, "out": written.out, "report": report, "warnings": written.warnings})
        return
    out.print(f"{written.out}")
    albedo = written.report.get("max_albedo")
    if albedo is not None:
        before = ", before scaling" if written.report.get("capped") else ""
        out.print(f"  largest directional albedo {albedo:.4f}{before}")
    for (side, kind), loss in written.report.get("loss", {}).items():
        quantity = "DHR" if kind == "reflection" else "DHT"
        out.print(
            f"  {side} {kind}: differs from the full model by {100 * loss['rel_l1']:.2f} % relative L1 "
            f"(largest {100 * loss['rel_l1_max']:.2f} %), "
            f"{quantity} by at most {loss['dhr_difference']:+.4f}, "
            f"peak {loss['peak_ratio']:.3f} of the model's where they differ most, "
            f"reciprocity {reciprocity_text(loss['reciprocity'])} "
            f"(model {reciprocity_text(loss['reciprocity_model'])})"
        )
        if loss["ideal_model"] > 0:
            out.print(
                f"  {side} {kind}, unscattered: {loss['ideal']:.4f} of the light "
                f"(model {loss['ideal_model']:.4f}), by at most {loss['ideal_difference']:+.4f}"
            )
    capped = written.report.get("capped")
    if capped:
        out.print(f"  {len(capped)} incident patches scaled down to albedo 1")


def _texts(value: object) -> object:
    """The same with every tuple that is a key as text: front-reflection."""
    if not isinstance(value, dict):
        return value
    return {
        "-".join(map(str, key)) if isinstance(key, tuple) else str(key): _texts(inner)
        for key, inner in value.items()
    }
