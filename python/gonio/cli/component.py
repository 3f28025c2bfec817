"""The option `--component SIDE-COMPONENT`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

Components = Annotated[
    list[str] | None,
    typer.Option(
        "--component",
        metavar="SIDE-COMPONENT",
        help="Such as front-reflection; repeat it. Without it all that scatter.",
    ),
]


def components_of(texts: Sequence[str] | None) -> list[tuple[str, str]] | None:
    """`front-reflection` as (front, reflection); None without any.

    Raises
    ------
    typer.BadParameter
        A text without a hyphen.
    """
    return [component_of(text) for text in texts] if texts else None


def component_of(text: str) -> tuple[str, str]:
    """`front-reflection` as (front, reflection)."""
    side, separator, component = text.partition("-")
    if not separator:
        raise typer.BadParameter(f"found {text!r}, allowed SIDE-COMPONENT", param_hint="--component")
    return side, component
