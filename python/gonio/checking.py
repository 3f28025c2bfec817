"""Checks of a measurement: each a verdict, a number and a sentence a lab engineer can act on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from gonio import _native
from gonio._native import Verdict
from gonio.measurement import Measurement
from gonio.readings import PathLike
from gonio.working import interruptible

MeasurementOrPath: TypeAlias = Measurement | PathLike
"""A measurement, or the directory of a saved one."""

LEVELS = ("info", "pass", "warn", "fail")
"""Verdicts from harmless to grave."""


def check(
    measurement: MeasurementOrPath,
    *,
    repeats: Sequence[MeasurementOrPath] = (),
    isotropic: bool | None = None,
) -> list[Verdict]:
    """Check a measurement.

    Exact copies of slices under other angles, negative readings, noise floor and dynamic range, coverage and
    grazing gap, energy, Helmholtz reciprocity, plausibility of the quantity, symmetry, resolution; where a
    blank was subtracted, whether it matched; with `repeats` also repeatability.

    Parameters
    ----------
    measurement
        What to check.
    repeats
        Further measurements of the same sample.
    isotropic
        Whether the sample is taken as isotropic where incidences are compared; None: when all incidences
        share one azimuth; no warning rests on that assumption alone.

    Returns
    -------
    list of Verdict
        In a fixed order. A check that does not apply says so with the verdict "info".

    Raises
    ------
    FormatError, OSError
        A saved measurement cannot be loaded.
    QuantityError
        `repeats` and `measurement` have nothing in common.
    """
    first = loaded(measurement)
    # A loaded measurement brings its findings itself: the core made them from raw readings that are gone.
    known = {verdict.id for verdict in first._data.findings}
    verdicts = [v for v in _gravest(first.findings) if v.id not in known]
    aligned = bool(first.provenance.get("settings", {}).get("align", False))
    verdicts += interruptible(lambda: _native.check(first._data, isotropic=isotropic, aligned=aligned))
    if repeats:
        every = [first._data, *(loaded(m)._data for m in repeats)]
        verdicts.append(interruptible(lambda: _native.repeatability(every)))
    return verdicts


def loaded(measurement: MeasurementOrPath) -> Measurement:
    """The measurement itself, or the one saved at that path."""
    return measurement if isinstance(measurement, Measurement) else Measurement.load(measurement)


def _gravest(findings: Sequence[Verdict]) -> list[Verdict]:
    """The gravest finding of each kind."""
    worst: dict[str, Verdict] = {}
    for finding in findings:
        known = worst.setdefault(finding.id, finding)
        if _gravity(finding) > _gravity(known):
            worst[finding.id] = finding
    return list(worst.values())


def _gravity(verdict: Verdict) -> tuple[int, float]:
    return LEVELS.index(verdict.verdict), verdict.value or 0.0
