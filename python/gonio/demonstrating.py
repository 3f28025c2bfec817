"""The whole chain on a known material: simulate, process, check, build, report, compare."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gonio._native import DataDriven, Verdict
from gonio.building import build
from gonio.checking import check
from gonio.exporting import RADIANCE_FORMATS, export
from gonio.files import growing_directory
from gonio.materials import Material
from gonio.measurement import Measurement
from gonio.processing import process
from gonio.reporting import report
from gonio.simulating import Campaign, simulate
from gonio.truth import Comparison, compare
from gonio.working import Progress, silent

DIRECTORY = "gonio-demo"
"""Where demos go unless told otherwise, each into a directory named after material and seed."""


@dataclass(frozen=True)
class DemoResult:
    """What a demo found and where its files are."""

    campaign: Campaign
    measurement: Measurement
    verdicts: tuple[Verdict, ...]
    model: DataDriven
    comparison: Comparison
    out: Path
    raw: Path
    measured: Path
    exports: tuple[Path, ...]
    report: Path
    seconds: float

    @property
    def held(self) -> bool:
        """Whether every claim of the measurement holds against the truth; see `gonio.truth.Comparison`."""
        return self.comparison.held

    def to_dict(self) -> dict[str, Any]:
        """Return the figures of the demo.

        readings of the sample; largest relative error and largest relative expanded uncertainty (k = 2) of a
        DHR or DHT; median relative error of the DSF above the noise floor; share of readings whose 95 %
        interval holds the truth; elapsed seconds.
        """
        return {
            "readings": self.comparison.readings,
            "dhr_error_max": self.comparison.dhr_error_max,
            "dhr_expanded_uncertainty_max": self.comparison.dhr_expanded_uncertainty_max,
            "dsf_error_median": self.comparison.dsf_error_median,
            "coverage_95": self.comparison.coverage_95,
            "seconds": self.seconds,
        }


def demo(
    *,
    material: str | Material = "plastic",
    seed: int = 1,
    incidences: Sequence[tuple[float, float]] | None = None,
    instrument: Mapping[str, float] | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Progress = silent,
) -> DemoResult:
    """Run the whole chain on a known material and compare with the truth.

    A virtual campaign is written as raw instrument files; these files alone are then processed, checked and
    made into a model as those of a real instrument are. Only the comparison at the end and the curves that
    the report draws over the readings know the material.

    Parameters
    ----------
    material, seed, incidences, instrument
        What to measure and how, as in `gonio.simulate`.
    out
        Directory of all files: raw/, measurement/, radiance-*.xml, report.html; None takes
        gonio-demo/MATERIAL-seedSEED in the working directory. Files of an earlier demo there are replaced
        one by one. A directory that was not there goes again when the demo does not come to its end.
    progress
        Called with stage, parts done and parts in all.

    Raises
    ------
    DomainError
        A parameter outside its range.
    OSError
        The file system refuses.
    """
    name = material if isinstance(material, str) else material.name
    target = Path(DIRECTORY, f"{name}-seed{seed}") if out is None else Path(out)
    with growing_directory(target):
        return _run(
            target,
            material=material,
            seed=seed,
            incidences=incidences,
            instrument=instrument,
            progress=progress,
        )


def _run(
    target: Path,
    *,
    material: str | Material,
    seed: int,
    incidences: Sequence[tuple[float, float]] | None,
    instrument: Mapping[str, float] | None,
    progress: Progress,
) -> DemoResult:
    """The demo in the directory `target`, which exists."""
    begin = time.monotonic()
    raw, measured, page = target / "raw", target / "measurement", target / "report.html"
    progress("simulating", 0, 1)
    campaign = simulate(material=material, seed=seed, incidences=incidences, instrument=instrument, out=raw)
    progress("simulating", 1, 1)
    measurement = process(
        campaign.sample, beam=campaign.beam, dark=campaign.dark, out=measured, progress=progress
    )
    progress("checking", 0, 1)
    verdicts = check(measurement)
    progress("checking", 1, 1)
    model = build(measurement, progress=progress)
    exports = tuple(
        export(model, to=to, out=target / f"{to}.xml", name=measurement.sample_name, progress=progress).out
        for to in RADIANCE_FORMATS
    )
    report(
        measurement,
        out=page,
        verdicts=verdicts,
        model=model,
        truth=campaign.material.bsdf,
        progress=progress,
    )
    progress("comparing", 0, 1)
    comparison = compare(measurement, material=campaign.material)
    progress("comparing", 1, 1)
    return DemoResult(
        campaign=campaign,
        measurement=measurement,
        verdicts=tuple(verdicts),
        model=model,
        comparison=comparison,
        out=target,
        raw=raw,
        measured=measured,
        exports=exports,
        report=page,
        seconds=time.monotonic() - begin,
    )
