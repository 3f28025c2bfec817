"""`gonio reduce`: any model as gonio's compact one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.component import Components, components_of
from gonio.cli.running import Json, out, print_json, progress_bar, warn
from gonio.comparing import reciprocity_text, summarised
from gonio.reducing import Reduction

Target = Annotated[
    float, typer.Option("--target", help="Relative L1 error at which the table is fine enough, such as 0.01.")
]
MaxBytes = Annotated[
    int | None,
    typer.Option(
        "--max-bytes",
        help="Most bytes of the table of one channel and component. Without it 16000 (isotropic) or 400000.",
    ),
]
Bits = Annotated[
    int | None, typer.Option("--bits", help="Bits of a value: 8 or 16. Without it the bytes decide.")
]
Direct = Annotated[
    bool,
    typer.Option(
        "--direct/--no-direct",
        help="Take peaks of a measurement that are as narrow as the beam out of the BSDF, as light that "
        "leaves unscattered.",
    ),
]
Name = Annotated[str | None, typer.Option("--name", help="Name of the material. Without it the sample's.")]


def reduce(
    model: Annotated[
        Path,
        typer.Argument(help="File of a model (XML, SIR, RGL, MERL, compact) or directory of gonio process."),
    ],
    target_file: Annotated[Path, typer.Option("-o", "--out", help="File of the compact model (.nc).")],
    channel: Annotated[
        list[str] | None, typer.Option("--channel", help="Channel to keep; repeat it. Without it all.")
    ] = None,
    component: Components = None,
    target: Target = 0.005,
    max_bytes: MaxBytes = None,
    bits: Bits = None,
    name: Name = None,
    direct: Direct = True,
    json: Json = False,
) -> None:
    """Write any model as gonio's compact one and show what that loses: a few kilobytes, fast to evaluate."""
    with progress_bar(hidden=json) as progress:
        reduction = gonio.reduce(
            model,
            out=target_file,
            channels=channel or None,
            components=components_of(component),
            target=target,
            max_bytes=max_bytes,
            bits=bits,
            name=name,
            direct=direct,
            progress=progress,
        )
    warn(reduction.warnings + reduction.loss.warnings)
    if json:
        print_json(reduction.to_dict())
        return
    show(reduction)


def show(reduction: Reduction) -> None:
    """Print file, size and loss."""
    if reduction.out is not None:
        out.print(f"{reduction.out}: {reduction.bytes} bytes")
    for (side, component), size in reduction.model.bytes_per_channel.items():
        rows = [r for r in reduction.loss.rows if (r.side, r.component) == (side, component)]
        loss = summarised(rows)
        if not math.isfinite(loss["rel_l1"]):
            out.print(f"  {side} {component}: {size} bytes a channel, unscattered light alone")
            continue
        quantity = "DHR" if component == "reflection" else "DHT"
        peak = 100 * (loss["peak_ratio"] - 1)
        out.print(
            f"  {side} {component}: table of {size} bytes a channel; from the full model "
            f"{100 * loss['rel_l1']:.2f} % relative L1 (largest {100 * loss['rel_l1_max']:.2f} %), "
            f"{quantity} by at most {loss['dhr_difference']:+.4f}, peak by {peak:+.1f} %, "
            f"reciprocity {reciprocity_text(loss['reciprocity_b'])} "
            f"(full {reciprocity_text(loss['reciprocity_a'])})"
        )
    for (side, component), error in reduction.model.report["ideal_error"].items():
        out.print(f"  {side} {component}: unscattered share within {100 * error:.2g} % of the light")
    out.print(f"  largest directional albedo {reduction.model.report['max_albedo']:.4f}")
