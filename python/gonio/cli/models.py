"""`gonio models`: the analytic models and their parameters."""

from __future__ import annotations

import dataclasses
from typing import Annotated

import typer

import gonio
from gonio import DomainError
from gonio.cli.running import Json, out, print_json


def models(
    name: Annotated[str | None, typer.Argument(help="Show this model only.")] = None,
    json: Json = False,
) -> None:
    """List the analytic scattering models, their parameters and the laws they break by design."""
    found = [m for m in gonio.models() if name in (None, m.name)]
    if not found:
        names = ", ".join(m.name for m in gonio.models())
        raise DomainError(f"model: found {name!r}, allowed {names}")
    if json:
        print_json({"models": [dataclasses.asdict(m) for m in found]})
        return
    for model in found:
        out.print(f"{model.name}: {model.title} [{model.source}], {model.scatters}")
        for p in model.parameters:
            unit = "" if p.unit == "1" else f" {p.unit}"
            out.print(f"    {p.name:<12} {p.low:.4g} to {p.high:.4g}{unit}, {p.meaning}")
        for law, amount in model.breaks.items():
            out.print(f"    breaks {law}: {amount}")
