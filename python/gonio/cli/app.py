"""The `gonio` command and its verbs."""

from __future__ import annotations

from typing import Annotated

import typer

import gonio
from gonio.cli.build import build
from gonio.cli.check import check
from gonio.cli.demo import demo
from gonio.cli.export import export
from gonio.cli.inspect import inspect
from gonio.cli.process import process
from gonio.cli.report import report
from gonio.cli.running import verb
from gonio.cli.simulate import simulate

app = typer.Typer(
    name="gonio",
    help="From the raw readings of a goniophotometer to a checked scattering model (BSDF).",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"gonio {gonio.__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


for function in (inspect, process, check, build, export, report, simulate, demo):
    verb(app, function)


def main() -> None:
    """Run the command line."""
    app()
