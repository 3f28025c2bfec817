"""The pages of docs/validation that are made from measurements and comparisons, one a module.

A module has `make()`, which gives the page's text or raises `Skipped` with what is missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence


class Skipped(Exception):
    """The page cannot be made here: data or a program is missing."""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)
