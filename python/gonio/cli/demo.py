"""`gonio demo`: the whole chain on a known material."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

import gonio
from gonio.cli.running import Json, out, print_json, progress_bar
from gonio.demonstrating import DemoResult
from gonio.materials import MATERIALS
from gonio.truth import Comparison


def demo(
    material: Annotated[str, typer.Option(help=f"{', '.join(MATERIALS)}.")] = "plastic",
    seed: Annotated[int, typer.Option(help="Seed of path, noise and drift.")] = 1,
    to: Annotated[
        Path | None, typer.Option("-o", "--out", help="Directory. Without it gonio-demo/MATERIAL-seedSEED.")
    ] = None,
    json: Json = False,
) -> None:
    """Measure a known material with a virtual goniophotometer and tell how close the result is."""
    with progress_bar(hidden=json) as progress:
        result = gonio.demo(material=material, seed=seed, out=to, progress=progress)
    if json:
        print_json(result.to_dict())
    else:
        _show(result)


def _show(result: DemoResult) -> None:
    c, material = result.comparison, result.campaign.material
    out.print(f"Measured {material.name} ({material.description}):")
    out.print(
        f"{c.readings:,} noisy readings over {len(result.measurement.slices)} incidences, "
        "processed without knowledge of the material.\n"
    )
    table = Table(box=None, pad_edge=False)
    for heading in ("theta_i", "phi_i", "", "measured", "truth", "error", "claimed ±", ""):
        table.add_column(heading, justify="right" if heading else "left")
    for i in c.integrals:
        table.add_row(
            f"{i.theta_i:.0f}°",
            f"{i.phi_i:.0f}°",
            i.name,
            f"{i.value:.4f}",
            f"{i.truth:.4f}",
            f"{100 * i.error:+.2f} %",
            f"{100 * i.expanded:.2f} %",
            "within" if i.held else "OUTSIDE",
        )
    out.print(table)
    out.print("\n" + "\n".join(_sentences(c)))
    out.print(_checks(result))
    out.print(f"\nraw readings  {result.raw}")
    out.print(f"measurement   {result.measured}")
    for path in result.exports:
        out.print(f"for Radiance  {path}")
    out.print(f"report        {result.report}")
    out.print(f"\n{result.seconds:.1f} s")


def _checks(result: DemoResult) -> str:
    grave = [f"{v.title} ({v.verdict})" for v in result.verdicts if v.verdict in ("warn", "fail")]
    return f"{len(result.verdicts)} checks of the measurement: " + (
        f"see the report on {', '.join(grave)}." if grave else "none objects."
    )


def _sentences(c: Comparison) -> list[str]:
    outside = sum(not i.held for i in c.integrals)
    claimed = 100 * c.dhr_expanded_uncertainty_max
    return [
        f"The hemispherical values are off by {100 * c.dhr_error_max:.2f} % at most; the result claims "
        f"± {claimed:.2f} % (k = 2) at most, and "
        + ("all of them hold." if not outside else f"{outside} of {len(c.integrals)} do NOT hold."),
        f"A DSF value above the noise floor is off by {100 * c.dsf_error_median:.2f} % in the median.",
        f"The claimed 95 % intervals hold the truth at {100 * c.coverage_95:.1f} % of the readings.",
        "Every claim holds." if c.held else "NOT every claim holds.",
    ]
