"""The `gonio` command and its verbs."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

import gonio
from gonio.cli.build import build
from gonio.cli.check import check
from gonio.cli.colour import colour
from gonio.cli.compare import compare
from gonio.cli.demo import demo
from gonio.cli.export import export
from gonio.cli.fit import fit
from gonio.cli.inspect import inspect
from gonio.cli.models import models
from gonio.cli.plan import plan
from gonio.cli.process import process
from gonio.cli.reduce import reduce
from gonio.cli.render import render
from gonio.cli.report import report
from gonio.cli.roughness import roughness
from gonio.cli.running import EXIT_ERROR, EXIT_INTERRUPTED, err, guarded, verb
from gonio.cli.simulate import simulate
from gonio.cli.specularity import specularity
from gonio.cli.sphere import sphere
from gonio.cli.surface import surface

app = typer.Typer(
    name="gonio",
    help="From the raw readings of a goniophotometer to a checked scattering model (BSDF).",
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


for function in (
    inspect,
    process,
    check,
    build,
    reduce,
    fit,
    compare,
    export,
    report,
    render,
    simulate,
    plan,
    models,
    sphere,
    specularity,
    roughness,
    surface,
    colour,
    demo,
):
    verb(app, function)


def main() -> None:
    """Run the command line; without arguments it lists the verbs."""
    code = 0

    def run() -> None:
        nonlocal code
        code = _command(sys.argv[1:] or ["--help"])

    sys.exit(guarded(run, debug=False) or code)


def _command(arguments: list[str]) -> int:
    """Exit code of the command; an error of usage is one line on stderr."""
    try:
        code = app(arguments, prog_name="gonio", standalone_mode=False) or 0
    except Exception as error:
        # Older typer has these from click, newer from within itself: only the method is common.
        if not hasattr(error, "format_message"):
            raise
        context = getattr(error, "ctx", None)
        verb = context.command_path if context else "gonio"
        message = " ".join(error.format_message().split()).rstrip(".")
        err.print(f"gonio: {message}; {verb} --help lists the options")
        return EXIT_ERROR
    # Verbs end with SystemExit when they have told of an interruption; this one came outside of them.
    if code == EXIT_INTERRUPTED:
        raise KeyboardInterrupt
    return int(code)
