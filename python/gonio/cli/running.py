"""What every verb shares: errors in one line, exit codes, JSON, progress."""

from __future__ import annotations

import functools
import inspect
import json
import math
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Annotated, Any, TypeVar, get_type_hints

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

import gonio
from gonio.working import Progress as Report

EXIT_ERROR = 2
EXIT_INTERNAL = 1
EXIT_INTERRUPTED = 130

F = TypeVar("F", bound=Callable[..., None])


@contextmanager
def _naming_stdout() -> Iterator[None]:
    """An error of the operating system on writing to stdout, with its name."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        # What is left in the buffer would fail once more at the exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise OSError(error.errno, error.strerror, "standard output") from error


class _Out(Console):
    """stdout; an error names it."""

    def print(self, *objects: Any, **options: Any) -> None:
        with _naming_stdout():
            super().print(*objects, **options)


out = _Out(soft_wrap=True, highlight=False, markup=False)
err = Console(stderr=True, soft_wrap=True, highlight=False, markup=False)

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
Force = Annotated[bool, typer.Option("--force", help="Write into a directory that holds other files.")]


def verb(app: typer.Typer, function: F) -> None:
    """Add `function` to `app` under its own name, with `--debug` and errors in one line."""

    @functools.wraps(function)
    def run(*args: Any, debug: bool = False, **kwargs: Any) -> None:
        code = guarded(lambda: function(*args, **kwargs), debug=debug)
        if code:
            raise SystemExit(code)

    hints = get_type_hints(function, include_extras=True) | {"debug": Debug}
    parameters = [
        p.replace(annotation=hints[p.name]) for p in inspect.signature(function).parameters.values()
    ]
    extra = inspect.Parameter("debug", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Debug)
    run.__signature__ = inspect.Signature([*parameters, extra])  # type: ignore[attr-defined]
    run.__annotations__ = hints
    app.command(function.__name__)(run)


def guarded(work: Callable[[], None], *, debug: bool) -> int:
    """Run `work` and give the exit code; an error is one line on stderr."""
    try:
        work()
        with _naming_stdout():
            sys.stdout.flush()
    except (typer.Exit, typer.Abort, typer.BadParameter, SystemExit):
        raise
    except KeyboardInterrupt as error:
        err.print(f"gonio: interrupted, {one_line(error) or 'nothing was written'}")
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader of stdout has gone (`gonio inspect … | head`); the exit must not try to flush again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_INTERNAL
    except (gonio.GonioError, OSError) as error:
        if debug:
            traceback.print_exc()
        err.print(f"gonio: {one_line(error)}")
        return EXIT_ERROR
    except MemoryError:
        err.print("gonio: not enough memory")
        return EXIT_ERROR
    except BaseException as error:  # a panic of the core is no Exception
        if debug:
            traceback.print_exc()
        err.print(
            f"gonio: internal error ({type(error).__name__}: {one_line(error)}); "
            "--debug shows where, please report it"
        )
        return EXIT_INTERNAL
    return 0


def one_line(error: BaseException) -> str:
    """The message of an error in one line; of an OSError file and reason without the number."""
    if isinstance(error, OSError) and error.strerror:
        name = error.filename2 or error.filename
        text = f"{os.fsdecode(name)}: {error.strerror}" if name else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())


def print_json(result: Mapping[str, Any]) -> None:
    """Print one JSON object; numbers that JSON does not have are null."""
    with _naming_stdout():
        sys.stdout.write(json.dumps(_plain(result), allow_nan=False) + "\n")
        sys.stdout.flush()


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, str) or value is None or isinstance(value, bool):
        return value
    if isinstance(value, Sequence):
        return [_plain(v) for v in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "item"):
        return _plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


@contextmanager
def progress_bar(*, hidden: bool = False) -> Iterator[Report]:
    """A progress bar on stderr as a progress callback; nothing is shown when stderr is no terminal."""
    columns = (
        TextColumn("{task.description:<24}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=err, transient=True, disable=hidden or not err.is_terminal) as bar:
        tasks: dict[str, Any] = {}

        def report(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bar.add_task(stage, total=total)
            bar.update(tasks[stage], completed=done, total=total)

        yield report


def warn(warnings: Sequence[str]) -> None:
    """Print physics warnings on stderr."""
    for text in warnings:
        err.print(f"gonio: warning: {text}")


def pairs(texts: Sequence[str], *, option: str) -> dict[str, str]:
    """`NAME=VALUE` options as a dict.

    Raises
    ------
    typer.BadParameter
        A text without `=`, or a name given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, separator, value = text.partition("=")
        if not separator or not name or not value:
            raise typer.BadParameter(f"found {text!r}, allowed NAME=VALUE", param_hint=option)
        if name in found:
            raise typer.BadParameter(f"{name} is given twice", param_hint=option)
        found[name] = value
    return found
