"""Fits of analytic models to measurements, and the choice between models."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gonio import _native
from gonio._native import DomainError, FitError, FormatError
from gonio.checking import MeasurementOrPath
from gonio.compact_files import COMPACT_FORMAT
from gonio.fit_parameters import FitModel, FitParameter
from gonio.fit_results import Fit, FitWarning, Ranking, fit_of
from gonio.fit_spheres import SphereReadings, loaded_readings
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME
from gonio.model_files import RGL_FORMAT, is_zemax, model_format
from gonio.provenance import input_file, provenance
from gonio.readings import PathLike
from gonio.tabulating import U_FLOOR, U_RELATIVE, tabulate
from gonio.working import Progress, interruptible, silent

METRICS = ("chi2", "cube_root", "log1p")
"""Measures of the distance between prediction and reading; docs/fit.md."""

LOSSES = ("soft-l1", "linear")
"""Losses of the residuals of chi2."""

WEIGHTS = ("predicted", "stated")
"""Where the weights of chi2 come from: the noise law at the prediction, or the stated u as it is."""

AUTO = "auto"
"""The model name that compares all models that suit the data."""


@functools.cache
def fit_models() -> tuple[FitModel, ...]:
    """Return every model that `fit` knows by name: Radiance's materials, and a diffuse part with each lobe.

    `fit` also takes sums by name, such as `lambert+ward-gmd+ward-gmd`.
    """
    return tuple(
        FitModel(
            name=row["name"],
            title=row["title"],
            parameters=tuple(FitParameter(**p) for p in row["parameters"]),
            parts=tuple(row["parts"]),
        )
        for row in _native.fit_models()
    )


def fit(
    measurement: MeasurementOrPath,
    *,
    model: str = AUTO,
    models: Sequence[str] = (),
    channels: Sequence[str] | None = None,
    component: str | None = None,
    metric: str = "chi2",
    loss: str = "soft-l1",
    weights: str = "predicted",
    by_solid_angle: bool = False,
    fixed: Mapping[str, float] | None = None,
    max_theta_s: float = 85.0,
    retro_radius: float = 0.0,
    signature: bool = True,
    compare: Sequence[str] = ("cube_root",),
    profile: bool = True,
    held_out: bool = True,
    u_relative: float | None = None,
    u_floor: float | None = None,
    sphere: SphereReadings | PathLike | None = None,
    progress: Progress = silent,
) -> Fit:
    """Fit an analytic model to all incidences and channels at once, or find the best of several.

    docs/fit.md says what is minimised, what the uncertainties hold and what the warnings mean.

    Parameters
    ----------
    measurement
        Processed readings, the directory they are saved in, or a file of a model: a measured material (RGL
        `.bsdf`), which is tabulated at the incidences it was measured at, or a compact one.
    model
        A name of `fit_models`, a sum such as `lambert+ward-gmd+ward-gmd`, or auto: all models that suit the
        data are fitted and ranked by the error at incidences left out in turn, near ties by AICc; one whose
        parameters the readings leave open, or that scatters more than all light, is passed over for a sound
        one of nearly the same error.
    models
        With `auto`: the names to compare in place of all.
    channels
        Channels to fit; None takes all. Colours and indices have a value a channel, widths one for all.
    component
        reflection or transmission; None takes what the model scatters into.
    metric
        chi2, cube_root or log1p.
    loss
        soft-l1 (outliers keep a bounded pull) or linear; of chi2 only.
    weights
        predicted (noise law at the prediction) or stated; of chi2 only.
    by_solid_angle
        Weigh chi2 by the solid angle of each reading, too.
    fixed
        Parameters held at a value, by name (angles in degrees): what another instrument knows better.
    max_theta_s
        Largest angle in degrees between receiver and the normal of its side.
    retro_radius
        Readings closer than this many degrees to the incidence are left out.
    signature
        Whether the beam profile of the measurement is folded into the model before it is compared.
    compare
        Further metrics whose minima show what the choice of metric leaves open (`Estimate.u_model`).
    profile
        Whether intervals come from the profile of the cost where the quadratic ones are wrong.
    held_out
        Whether a single model is also fitted without each incidence in turn; auto always does.
    u_relative, u_floor
        Of a file of a measured material: the standard uncertainty its values are given, relative and at dsf 0
        in 1/sr, as in `gonio.tabulate`; None is 0.01 and 0.0002. A measurement states its own.
    sphere
        Readings of an integrating sphere, or their file (docs/formats/sphere-toml.md), that count as data
        beside those of the goniometer; `Fit.sphere` compares each with the model and states its cone.
    progress
        Called with stage, parts done and parts in all.

    Returns
    -------
    Fit
        The fit of the model, of the best one with `auto`; its `ranking` then holds all.

    Raises
    ------
    FitError
        Nothing to fit: too few readings, no signal, readings on the side the model does not scatter to, or no
        minimum. The message says what to do.
    DomainError
        An unknown model, parameter or option, or a value out of range.
    QuantityError
        A channel that the measurement does not have.
    FormatError, OSError
        A file cannot be loaded.

    Examples
    --------
    >>> from gonio.materials import material
    >>> sample = gonio.tabulate(material("plastic").bsdf, pitch=8, peak_pitch=1)
    >>> found = gonio.fit(sample, model="plastic")
    >>> round(found.estimate("alpha").value, 3)
    0.15
    """
    settings: dict[str, Any] = {
        "metric": metric,
        "loss": loss,
        "weights": weights,
        "by_solid_angle": by_solid_angle,
        "channels": _names(channels, "channels"),
        "component": component,
        "max_theta_s": float(max_theta_s),
        "retro_radius": float(retro_radius),
        "signature": signature,
        "fixed": {name: float(value) for name, value in (fixed or {}).items()},
        "compare": _names(compare, "compare"),
        "profile": profile,
    }
    wanted = _names(models, "models")
    if wanted and model != AUTO:
        raise DomainError(f"models (--compare): found with model {model!r}, allowed only with {AUTO}")
    if not 0.0 < max_theta_s <= 90.0:
        raise DomainError(f"max_theta_s: found {max_theta_s:g} degrees, allowed above 0 to 90")
    if not 0.0 <= retro_radius <= 180.0:
        raise DomainError(f"retro_radius: found {retro_radius:g} degrees, allowed 0 to 180")
    stated = {
        name: float(u) for name, u in (("u_relative", u_relative), ("u_floor", u_floor)) if u is not None
    }
    sample, inputs = fit_input(measurement, channels=channels, stated=stated)
    if sphere is not None:
        settings["sphere"] = loaded_readings(sphere).native(channels=settings["channels"] or sample.channels)
        if not isinstance(sphere, SphereReadings):
            inputs = [*inputs, input_file(Path(sphere), role="sphere")]
    _require_component(sample, component, settings["channels"])
    origin = provenance(inputs=inputs, settings={"model": model, "models": wanted} | settings | stated)
    if "primaries" in sample.provenance:
        origin["primaries"] = sample.provenance["primaries"]
    progress("fitting", 0, 1)
    known = _known(sample, settings["channels"])
    found = interruptible(
        lambda: (
            _best(sample, wanted, settings, origin, known)
            if model == AUTO
            else _one(sample, model, settings, origin, known, held_out=held_out)
        )
    )
    progress("fitting", 1, 1)
    return found


def _one(
    sample: Measurement,
    model: str,
    settings: dict[str, Any],
    origin: Mapping[str, Any],
    known: Sequence[FitWarning],
    *,
    held_out: bool,
) -> Fit:
    data = _native.fit(sample._data, model=model, settings=settings)
    errors = _native.held_out(sample._data, data, settings=settings) if held_out else []
    return fit_of(data, held_out=errors, provenance=origin, warnings=known)


def _best(
    sample: Measurement,
    models: Sequence[str],
    settings: dict[str, Any],
    origin: Mapping[str, Any],
    known: Sequence[FitWarning],
) -> Fit:
    choice = _native.select(sample._data, models=models, settings=settings)
    fits = tuple(
        fit_of(data, held_out=rows, provenance=origin, warnings=known) for data, _, rows in choice["ranking"]
    )
    ranking = Ranking(
        fits=fits,
        failed=choice["failed"],
        sentence=choice["sentence"],
        passed_over=choice["passed_over"],
    )
    return dataclasses.replace(fits[0], ranking=ranking)


def _known(sample: Measurement, channels: Sequence[str]) -> list[FitWarning]:
    """What the check of reciprocity says against fitting any of the models, which all are reciprocal."""
    verdict = interruptible(lambda: _native.reciprocity(sample._data, channels=channels))
    if verdict.verdict not in ("warn", "fail"):
        return []
    graded = "fails" if verdict.verdict == "fail" else "warns"
    return [
        FitWarning(
            "reciprocity",
            f"the check of reciprocity {graded}: {verdict.sentence} Every model of this fit is reciprocal "
            "and averages what the two directions say",
        )
    ]


def fit_input(
    measurement: MeasurementOrPath,
    *,
    channels: Sequence[str] | None = None,
    stated: Mapping[str, float] | None = None,
) -> tuple[Measurement, list[dict[str, Any]]]:
    """The readings to fit and the files they come from; `stated` are uncertainties for those of a model."""
    if stated and (isinstance(measurement, Measurement) or Path(measurement).is_dir()):
        name, value = next(iter(stated.items()))
        raise DomainError(
            f"{name}: found {value:g} for a measurement, which states the uncertainty of its readings, "
            "allowed for a file of a measured material: state it to gonio process (or gonio.tabulate)"
        )
    if isinstance(measurement, Measurement):
        return measurement, [{"name": measurement.sample_name, "role": "measurement"}]
    path = Path(measurement)
    if path.is_file() and is_zemax(path):
        raise FormatError(
            f"{path}: found readings (Zemax tabular BSDF), needed a processed measurement: run gonio process "
            f"{path.name} -o out, then gonio fit out"
        )
    if path.is_file() and model_format(path) in (RGL_FORMAT, COMPACT_FORMAT):
        known = {"u_relative": U_RELATIVE, "u_floor": U_FLOOR} | dict(stated or {})
        sample = tabulate(path, channels=channels, u_relative=known["u_relative"], u_floor=known["u_floor"])
        return sample, [input_file(path, role="measurement")]
    sample = Measurement.load(path)
    return sample, [input_file(path / JSON_NAME, role="measurement")]


def _require_component(sample: Measurement, component: str | None, channels: Sequence[str]) -> None:
    """Refuse a component of which the measurement has no reading."""
    if component not in ("reflection", "transmission"):
        return
    slices = [s for s in sample if not channels or s.channel in channels]
    reflected = (bool(np.any((s.theta_s <= 90.0) == (s.theta_i <= 90.0))) for s in slices)
    transmitted = (bool(np.any((s.theta_s <= 90.0) != (s.theta_i <= 90.0))) for s in slices)
    if slices and not any(reflected if component == "reflection" else transmitted):
        other = "transmission" if component == "reflection" else "reflection"
        raise FitError(
            f"component: found no {component} readings in this measurement, allowed {other}: process "
            "readings of the other side, or check the convention of theta_s"
        )


def _names(names: Sequence[str] | None, field: str) -> list[str]:
    if isinstance(names, str):
        raise DomainError(f"{field}: found the text {names!r}, allowed a list of names")
    return list(names or ())
