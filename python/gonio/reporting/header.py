"""The head of the page: what was measured, and in one sentence what the checks say."""

from collections.abc import Sequence
from typing import Any

from gonio._drawing.numbers import number, rounded
from gonio._drawing.shapes import MeasurementLike, VerdictLike
from gonio.reporting.drawn import DrawnSlice
from gonio.reporting.provenance import find, sample_file
from gonio.reporting.wording import in_symbols, when

ICONS = {"pass": "✓", "warn": "!", "fail": "✕", "info": "i"}
"""The sign of each verdict, so that colour is never needed to tell them apart."""

RATIOS = ("dynamic_range", "resolution")
"""Checks whose value tells how many times one quantity is another."""

_ORDER = ("fail", "warn", "pass", "info")


def describe(
    measurement: MeasurementLike,
    verdicts: Sequence[VerdictLike],
    *,
    title: str | None,
    drawn: list[DrawnSlice],
) -> dict[str, Any]:
    """Heading, facts and summary of the page."""
    readings, shown = sum(d.readings for d in drawn), sum(d.drawn for d in drawn)
    name = measurement.sample_name or sample_file(measurement.provenance) or "unnamed sample"
    incidences = len({(round(d.slice.theta_i, 4), round(d.slice.phi_i, 4)) for d in drawn})
    fwhm = measurement.signature_fwhm
    facts = [
        ("Sample", name if title else None),
        ("Instrument", find(measurement.provenance, ("instrument",))),
        ("Measured", when(find(measurement.provenance, ("started", "measured", "date")))),
        ("Processed", when(find(measurement.provenance, ("created",)))),
        ("Readings", f"{grouped(readings)} at {incidences} incidence{'s' if incidences != 1 else ''}"),
        ("Resolution", f"{number(fwhm, 3)}° beam FWHM" if fwhm else "beam not measured"),
    ]
    return {
        "title": title or name,
        "facts": [(label, value) for label, value in facts if value],
        "status": worst(verdicts),
        "icon": ICONS[worst(verdicts)],
        "summary": summary(verdicts),
        "readings": grouped(readings),
        "drawn": grouped(shown),
        "thinned": any(d.thinned for d in drawn),
    }


def worst(verdicts: Sequence[VerdictLike]) -> str:
    """Find the verdict that the reader must see first."""
    found = {_known(v.verdict) for v in verdicts}
    return next((verdict for verdict in _ORDER if verdict in found), "info")


def summary(verdicts: Sequence[VerdictLike]) -> str:
    """One sentence: how many checks pass, and the title of each that does not."""
    judged = [v for v in verdicts if _known(v.verdict) != "info"]
    if not judged:
        return "No check was run on this measurement."
    failed = [v.title for v in judged if _known(v.verdict) == "fail"]
    warned = [v.title for v in judged if _known(v.verdict) == "warn"]
    passed = len(judged) - len(failed) - len(warned)
    if not failed and not warned:
        return "The check passes." if len(judged) == 1 else f"All {len(judged)} checks pass."
    parts = [f"{passed} of {len(judged)} checks pass"]
    if failed:
        parts.append(f"{_listed(failed)} {'fails' if len(failed) == 1 else 'fail'}")
    if warned:
        parts.append(f"{_listed(warned)} {'needs' if len(warned) == 1 else 'need'} a look")
    return "; ".join(parts) + "."


def verdict_row(verdict: VerdictLike) -> dict[str, str]:
    """One row of the verdict table."""
    known = _known(verdict.verdict)
    return {
        "id": verdict.id,
        "title": verdict.title,
        "verdict": known,
        "icon": ICONS[known],
        "value": "" if verdict.value is None else _short(verdict.value),
        "unit": _unit(verdict) if verdict.value is not None else "",
        "sentence": in_symbols(verdict.sentence),
    }


def grouped(count: int) -> str:
    """Write an integer with its thousands set apart."""
    return f"{count:,}".replace(",", "\u202f")


def _short(value: float) -> str:
    """Three significant digits, thousands set apart."""
    short = rounded(value, 3)
    return grouped(int(short)) if 1e4 <= short < 1e6 else number(short, 3)


def _unit(verdict: VerdictLike) -> str:
    """Unit for the reader: ratios carry a multiplication sign, other plain numbers nothing."""
    if verdict.id in RATIOS:
        return "×"
    return "" if verdict.unit in (None, "1") else str(verdict.unit)


def _known(verdict: str) -> str:
    return verdict if verdict in ICONS else "info"


def _listed(titles: list[str]) -> str:
    quoted = [f"“{title}”" for title in titles]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"
