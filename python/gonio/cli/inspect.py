"""`gonio inspect`: what is in these files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.reading import Channel, Columns, Format, Quantity, UpPhi, column_map
from gonio.cli.running import Json, err, one_line, out, print_json
from gonio.inspecting import FileSummary, MaterialSummary, RecordSummary
from gonio.model_files import ComponentSummary


def inspect(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Reading files, measurement directories, models (BSDF XML, RGL), materials (.rad)."
        ),
    ],
    format: Format = None,
    column: Columns = None,
    quantity: Quantity = None,
    channel: Channel = None,
    upphi: UpPhi = None,
    json: Json = False,
) -> None:
    """Show what is in files: format, records, incidences, channels, ranges, problems; components of a model.

    A file that cannot be read does not stop the others; the exit code is 2 then.
    """
    found = gonio.inspect(
        files,
        format=format,
        columns=column_map(column),
        quantity=quantity,
        channel=channel,
        upphi=upphi,
        keep_going=True,
    )
    if json and (found.files or not found.failed):
        print_json(found.to_dict())
    elif not json:
        for file in found.files:
            _show(file)
        for problem in found.problems:
            err.print(f"gonio: note: {problem}")
    errors = list(found.failed.values())
    for error in errors[:-1]:
        err.print(f"gonio: {one_line(error)}")
    if errors:
        raise errors[-1]


def _show(file: FileSummary) -> None:
    if file.materials is not None:
        rows = [_material(m) for m in file.materials]
        held = _count(len(rows), "material")
    elif file.model is None:
        rows = [_row(record) for record in file.records]
        held = f"{_count(len(rows), 'record')}; {_units(file.records)}"
    else:
        rows = [_component(c) for c in file.model.components]
        held = _count(len(rows), "component")
    names = {
        "sample": file.sample_name,
        "instrument": file.instrument,
        "manufacturer": file.model.manufacturer if file.model else None,
    }
    told = "".join(f", {label} {name}" for label, name in names.items() if name)
    out.print(f"{file.path} ({file.format}, {held}){told}", style="bold")
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        line = "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True))
        out.print(f"  {line.rstrip()}")


def _units(records: Sequence[RecordSummary]) -> str:
    """What the numbers of the rows are in."""
    quantities = dict.fromkeys(r.quantity for r in records)
    of = {"signal": "as read", "reflectance_factor": "no unit"}
    return ", ".join(["angles in deg", *(f"{q} {of.get(q, 'in 1/sr')}" for q in quantities)])


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _material(m: MaterialSummary) -> list[str]:
    values = " ".join(f"{name} {value:g}" for name, value in m.parameters.items())
    modified = "" if m.modifier == "void" else f"modified by {m.modifier}"
    return [m.id, m.type, values, " ".join(m.strings), modified]


def _component(c: ComponentSummary) -> list[str]:
    return [
        c.channel,
        f"{c.side} {c.component}",
        f"{c.representation} ({c.resolution})",
        f"albedo {c.albedo_min:.4f} to {c.albedo_max:.4f}",
    ]


def _row(r: RecordSummary) -> list[str]:
    return [
        f"{r.kind} {r.quantity}",
        r.channel,
        f"theta_i {r.theta_i:.4g}",
        f"phi_i {r.phi_i:.4g}",
        _count(r.readings, "reading"),
        "" if r.theta_s_min is None else f"theta_s {r.theta_s_min:.4g} to {r.theta_s_max:.4g}",
        "" if r.phi_s_min is None else f"phi_s {r.phi_s_min:.4g} to {r.phi_s_max:.4g}",
        "" if r.value_min is None else f"{r.quantity} {r.value_min:.4g} to {r.value_max:.4g}",
        "; ".join(r.notes),
    ]
