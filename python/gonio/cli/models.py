"""`gonio models`: the analytic models and their parameters."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Annotated

import typer

import gonio
from gonio import DomainError
from gonio.analytic import ModelParameter
from gonio.cli.running import Json, out, print_json
from gonio.fit_parameters import FitParameter


def models(
    name: Annotated[str | None, typer.Argument(help="Show this model only.")] = None,
    json: Json = False,
) -> None:
    """List the analytic scattering models, and the Radiance materials of gonio fit, with their parameters."""
    fitted = {m.name for m in gonio.fit_models()}
    analytic = {m.name for m in gonio.models()}
    found = [m for m in gonio.models() if name in (None, m.name)]
    materials = [m for m in gonio.fit_models() if m.name not in analytic and name in (None, m.name)]
    if not found and not materials:
        names = ", ".join(sorted(analytic | fitted))
        raise DomainError(f"model: found {name!r}, allowed {names}")
    if json:
        print_json(
            {
                "models": [dataclasses.asdict(m) | {"fitted": m.name in fitted} for m in found],
                "materials": [dataclasses.asdict(m) for m in materials],
            }
        )
        return
    for material in materials:
        parts = ", ".join(material.parts)
        out.print(f"{material.name}: {material.title}, of gonio fit; the sum of {parts} [Radiance]")
        _print_parameters(material.parameters)
    for model in found:
        out.print(f"{model.name}: {model.title} [{model.source}], {model.scatters}")
        _print_parameters(model.parameters)
        if model.name not in fitted:
            out.print("    not in gonio fit: evaluated only, by gonio.analytic")
        for law, amount in model.breaks.items():
            out.print(f"    breaks {law}: {amount}")


def _print_parameters(parameters: Sequence[ModelParameter | FitParameter]) -> None:
    for p in parameters:
        unit = "" if p.unit == "1" else f" {p.unit}"
        out.print(f"    {p.name:<12} {p.low:.4g} to {p.high:.4g}{unit}, {p.meaning}")
