"""What readings tell of a material before a campaign: the model that a path is planned for."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gonio._native import FormatError
from gonio.fitting import fit
from gonio.materials import Component, Material
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME
from gonio.processing import process
from gonio.working import Progress, silent

POOR = 0.1
"""Relative L1 distance of a model from the readings from which on it is said."""


def measurement_of_directory(directory: Path, *, progress: Progress = silent) -> Measurement:
    """Load a measurement, or process the raw files `sample*`, `beam*`, `dark*` of a fast scan.

    Raises
    ------
    FormatError
        Neither is there.
    """
    if (directory / JSON_NAME).is_file():
        return Measurement.load(directory)
    raw = {
        kind: sorted(p for p in directory.glob(f"{kind}*") if p.suffix in (".txt", ".parquet"))
        for kind in ("sample", "beam", "dark")
    }
    if not raw["sample"]:
        raise FormatError(
            f"{directory}: found neither a measurement ({JSON_NAME}) nor raw files (sample*, beam*, dark*), "
            "allowed either"
        )
    return process(raw["sample"], beam=raw["beam"] or None, dark=raw["dark"] or None, progress=progress)


def material_of_measurement(
    measurement: Measurement, *, progress: Progress = silent
) -> tuple[Material, list[str]]:
    """Return the best analytic model of a measurement as a material, and sentences on how far it is known.

    Raises
    ------
    FitError
        The readings cannot be fitted.
    """
    best = fit(measurement, compare=(), profile=False, progress=progress)
    components: list[Component] = []
    for s in measurement.slices:
        reflected = (np.asarray(s.theta_s) <= 90.0) == (s.theta_i <= 90.0)
        if reflected.any() and "reflection" not in components:
            components.append("reflection")
        if not reflected.all() and "transmission" not in components:
            components.append("transmission")
    incidences = tuple(dict.fromkeys((s.theta_i, s.phi_i) for s in measurement.slices))
    off = float(np.mean([r.relative_l1 for r in best.residuals])) if best.residuals else 0.0
    values = ", ".join(f"{e.name} {e.value:.3g}" for e in best.estimates)
    known = Material(
        measurement.sample_name or "measured",
        f"{best.model} of {best.readings} readings: {values}",
        best.bsdf(),
        tuple(components),
        incidences,
    )
    notes = []
    if off > POOR:
        notes.append(
            f"the model that is planned for ({best.model}) is {off:.0%} off the readings it was fitted to: "
            "lobes that it lacks are missed"
        )
    return known, notes
