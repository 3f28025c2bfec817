"""From a measurement to a model that answers everywhere."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from gonio import _native
from gonio._native import DataDriven
from gonio.checking import MeasurementOrPath, loaded
from gonio.working import Progress, interruptible, silent

COVERAGE = ("measured", "interpolated", "extrapolated", "missing")
"""Names of the codes that `DataDriven.coverage` returns."""

CANDIDATES = tuple(
    name + suffix
    for name in (
        "model x half-vector",
        "model x components",
        "model x turned components",
        "model x mirror-frame",
        "model x cosine-shift",
        "model x ratio",
        "base + half-vector",
        "base + mirror-frame",
        "base + cosine-shift",
        "tracked lobes",
        "mirror-frame",
        "naive",
        "displaced light",
    )
    for suffix in ("", ", cubic", ", quadratic")
)
"""Names of the interpolations over incidence."""


def build(
    measurement: MeasurementOrPath,
    *,
    channel: str | None = None,
    symmetry: str = "auto",
    smooth: bool = True,
    candidate: str | None = None,
    direct: bool = True,
    progress: Progress = silent,
) -> DataDriven:
    """Build the data-driven model of one channel: measured slices, interpolated.

    docs/models/data-driven.md says what is interpolated how, and what happens beyond the data.

    Parameters
    ----------
    measurement
        Processed readings of at least two incidences, or the directory they are saved in.
    channel
        Name of the channel; may be left out when there is only one.
    symmetry
        auto (decided from the data), isotropic or anisotropic.
    smooth
        Whether readings are smoothed within their stated noise.
    candidate
        Interpolation over incidence, one of `CANDIDATES`; by default the one with the least
        leave-one-incidence-out error.
    direct
        Whether a peak in the mirror or through direction that is as narrow as the beam becomes the ideal
        part of the model (`delta`), apart from the BSDF; needs a measurement that knows its beam. Otherwise
        it stays in the BSDF as the instrument saw it.
    progress
        Called with stage, steps done and steps in all, from the calling thread and some twenty times a second
        at most: "building" as a whole, and within it reading, fitting bases, slices, symmetry, resampling,
        refitting bases, leaving incidences out (candidates), choosing, for one side and component after the
        other. An exception that it raises stops the build, as Ctrl-C does.

    Returns
    -------
    DataDriven
        A `Bsdf` that also tells its leave-one-incidence-out errors (`loo`, the largest is `loo_error`), the
        error it states at any incidence (`stated_error`, a list of them `stated_errors`), the uncertainty of
        any value by its sources (`uncertainty`), how it was built (`summary`), the light that leaves
        unscattered (`direct`), what to know (`warnings`), and how each value is known (`coverage`, see
        `COVERAGE`).

    Raises
    ------
    QuantityError
        The channel is not in the measurement, or not named among several.
    FitError
        Fewer than two incidences, or readings that do not span a hemisphere.
    DomainError
        An option outside its choices.
    FormatError, OSError
        A saved measurement cannot be loaded.
    """
    data = loaded(measurement)._data
    watch = _native.BuildWatch()
    last = ("building", 0, 1)
    progress(*last)

    def tell() -> None:
        nonlocal last
        now = watch.progress()
        if now[2] > 0 and now != last:
            if now[0] != last[0] != "building":
                progress(last[0], last[2], last[2])
            last = now
            progress(*now)

    model = interruptible(
        lambda: _native.build(
            data,
            channel=channel,
            symmetry=symmetry,
            smooth=smooth,
            candidate=candidate,
            direct=direct,
            watch=watch,
        ),
        tick=tell,
        stop=watch.stop,
    )
    if last[0] != "building":
        progress(last[0], last[2], last[2])
    progress("building", 1, 1)
    return model


def stated_errors(model: DataDriven) -> list[dict[str, Any]]:
    """The errors that a data-driven model states: at the measured incidences, between them and just beyond.

    Parameters
    ----------
    model
        A model of `build`.

    Returns
    -------
    list of dict
        Rows with side, component, theta_i and phi_i (degrees), measured (whether a slice stands there), and
        the relative L1 error of the DSF: slice (noise, the distance of readings, and how far repeats of one
        incidence differ beyond their noise), incidence (between or beyond the measured ones; None where no
        incidence could be left out to tell), total; coverage of the incidence (measured, interpolated,
        extrapolated); extrapolated, the share of the light that goes where no readings stand, whose error is
        in none of them. Incidences between and beyond are those of isotropic samples, half a step away.
    """
    rows: list[dict[str, Any]] = []
    for part in model.summary:
        measured = [(s["theta_i"], s["phi_i"]) for s in part["slices"]]
        places = [(theta, phi, True) for theta, phi in measured]
        if model.properties["isotropic"]:
            steps = list(pairwise(measured))
            places += [((a + b) / 2, phi, False) for (a, phi), (b, _) in steps]
            if steps:
                (a, phi), (b, _) = steps[-1]
                edge = b + (b - a) / 2
                if min(abs(edge - 90), abs(b - 90)) > 0 and (edge < 90) == (b < 90):
                    places.append((edge, phi, False))
        for theta, phi, there in sorted(places):
            stated = model.stated_error(theta_i=theta, phi_i=phi, component=part["component"])
            row = {"side": part["side"], "component": part["component"], "theta_i": theta, "phi_i": phi}
            rows.append(row | {"measured": there} | (stated or {}))
    return rows
