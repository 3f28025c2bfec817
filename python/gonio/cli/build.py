"""`gonio build`: a data-driven model and its errors."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

import gonio
from gonio.building import CANDIDATES, stated_errors
from gonio.cli.reduce import Bits, Direct, MaxBytes, Name, Target, show
from gonio.cli.running import Json, out, print_json, progress_bar, warn
from gonio.files import check_file

Channel = Annotated[
    str | None,
    typer.Option("--channel", help="Channel such as photopic or 532nm; needed where there are several."),
]
Symmetry = Annotated[
    str, typer.Option("--symmetry", help="auto (told from the data), isotropic or anisotropic.")
]
Smooth = Annotated[
    bool, typer.Option("--smooth/--no-smooth", help="Smooth readings within their stated noise.")
]
Candidate = Annotated[
    str | None,
    typer.Option(
        "--candidate",
        help=f"Interpolation over incidence: {'; '.join(CANDIDATES)}. Without it the one that predicts "
        "left-out incidences best.",
    ),
]


def build(
    measurement: Annotated[Path, typer.Argument(help="Directory written by gonio process.")],
    channel: Channel = None,
    symmetry: Symmetry = "auto",
    smooth: Smooth = True,
    candidate: Candidate = None,
    direct: Direct = True,
    target_file: Annotated[
        Path | None, typer.Option("-o", "--out", help="File of the compact model of it (.nc).")
    ] = None,
    target: Target = 0.005,
    max_bytes: MaxBytes = None,
    bits: Bits = None,
    name: Name = None,
    json: Json = False,
) -> None:
    """Build a data-driven model and show how well it predicts incidences it was not given.

    With -o its compact model is written, and what that loses against the full one is shown; gonio export
    writes the model for other programs. Without either nothing is written.
    """
    if target_file is not None:
        check_file(target_file)
        if target_file.suffix != ".nc":
            raise typer.BadParameter(
                f"found {target_file.name}, allowed a name that ends in .nc; gonio export writes others",
                param_hint="--out",
            )
    with progress_bar(hidden=json) as progress:
        model = gonio.build(
            measurement,
            channel=channel,
            symmetry=symmetry,
            smooth=smooth,
            candidate=candidate,
            direct=direct,
            progress=progress,
        )
        reduction = None
        if target_file is not None:
            title = name if name is not None else gonio.Measurement.load(measurement).sample_name
            reduction = gonio.reduce(
                model,
                out=target_file,
                target=target,
                max_bytes=max_bytes,
                bits=bits,
                name=title,
                progress=progress,
            )
    warn(model.warnings if reduction is None else reduction.warnings)
    if json:
        print_json(
            {
                "channels": model.channels,
                "properties": model.properties,
                "loo_error": model.loo_error,
                "loo": model.loo,
                "direct": model.direct,
                "stated": stated_errors(model),
                "summary": model.summary,
                "warnings": model.warnings,
                "reduction": None if reduction is None else reduction.to_dict(),
            }
        )
        return
    stated = stated_errors(model)
    for part in model.summary:
        base = f" ({part['base']})" if part["base"] else ""
        out.print(
            f"{part['side']} {part['component']}: {part['incidences']} incidences, "
            f"{part['readings']} readings, interpolated by {part['candidate']}{base}"
        )
        for row in model.direct:
            if _of(row, part):
                out.print(
                    f"  unscattered at {place(row)}: {100 * row['share']:.2f} % of the light "
                    f"(u {100 * row['u_share']:.2f} %)"
                )
        for row in stated:
            if _of(row, part):
                out.print(f"  stated error (relative L1) at {place(row)}: {of_error(row)}")
        noisy = [row for row in stated if row["slice"] > NOISE and _of(row, part)]
        if noisy and any(_of(row, part) for row in model.direct):
            out.print(
                f"  beside the unscattered light there is little above the noise at {len(noisy)} incidences: "
                "errors of that little, not of the light"
            )
    for row in model.loo:
        rms = 100 * row["rel_rms"]
        out.print(f"  {row['component']} at {place(row)} predicted from the others: {rms:.2f} % rms")
    if reduction is not None:
        show(reduction)


NOISE = 0.5
"""Relative L1 error from which a slice beside unscattered light holds little but noise."""


def _of(row: Mapping[str, Any], part: Mapping[str, Any]) -> bool:
    """Whether a row is of the side and component of a part."""
    return (row["side"], row["component"]) == (part["side"], part["component"])


def place(row: Mapping[str, Any]) -> str:
    """An incidence in words."""
    return f"theta_i {row['theta_i']:.4g}, phi_i {row['phi_i']:.4g}"


def of_error(row: Mapping[str, Any]) -> str:
    """A stated error in words."""
    beyond = row["coverage"] == "extrapolated"
    outside = ""
    if row["extrapolated"] >= 0.001:
        outside = f"; {100 * row['extrapolated']:.1f} % of the light goes where nothing was read"
    if row["measured"]:
        return f"{100 * row['slice']:.2f} % (measured){outside}"
    where = "beyond the incidences" if beyond else "between incidences"
    if row["incidence"] is None:
        return f"slices {100 * row['slice']:.2f} %, {where} not known{outside}"
    return (
        f"{100 * row['total']:.2f} % (slices {100 * row['slice']:.2f} %, "
        f"{where} {100 * row['incidence']:.2f} %){outside}"
    )
