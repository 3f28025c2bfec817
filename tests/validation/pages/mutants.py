"""Which test notices which mistake."""

from __future__ import annotations

from tests.mutants.driver import Outcome, check

from . import table

TEXT = """# Mistakes that the tests notice

Made by `python -m tests.validation mutants`: {count} mistakes, put into a copy of the scattering models one at a time
(tests/mutants/edits.py). For each, the tests of samplers (χ², acceptance, mean weight) run over the models named; when they notice
nothing the other laws (reciprocity, energy, finite values), then the closed forms and worked examples. A mistake that nothing notices fails `make validate`. Without any mistake all of these tests pass.

{table}"""

SHOWN = 3


def row(outcome: Outcome) -> list[str]:
    """The row of one mistake."""
    names = [name.rsplit("::", 1)[-1].replace("_", " ") for name in outcome.noticed_by]
    more = f", and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    where = f"`{outcome.mutant.file}`: {', '.join(outcome.mutant.models)}"
    return [outcome.mutant.mistake, where, "; ".join(names[:SHOWN]) + more]


def make() -> str:
    """The page."""
    outcomes = check()
    if survivors := [o.mutant.mistake for o in outcomes if not o.noticed_by]:
        raise AssertionError(f"no test notices: {'; '.join(survivors)}")
    rows = [row(o) for o in outcomes]
    return TEXT.format(count=len(rows), table=table(["mistake", "where", "noticed by"], rows))
