"""From a measurement to a model that answers everywhere."""

from __future__ import annotations

from gonio import _native
from gonio._native import DataDriven
from gonio.measurement import Measurement

COVERAGE = ("measured", "interpolated", "extrapolated", "missing")
"""Names of the codes that `DataDriven.coverage` returns."""


def build(
    measurement: Measurement,
    *,
    channel: str | None = None,
    symmetry: str = "auto",
    smooth: bool = True,
    candidate: str | None = None,
) -> DataDriven:
    """Build the data-driven model of one channel: measured slices, interpolated.

    docs/models/data-driven.md says what is interpolated how, and what happens beyond the data.

    Parameters
    ----------
    measurement
        Processed readings of at least two incidences.
    channel
        Name of the channel; may be left out when there is only one.
    symmetry
        auto (decided from the data), isotropic or anisotropic.
    smooth
        Whether readings are smoothed within their stated noise.
    candidate
        Interpolation over incidence by name, as in `DataDriven.summary`; by default the one with the least
        leave-one-incidence-out error.

    Returns
    -------
    DataDriven
        A `Bsdf` that also tells its leave-one-incidence-out errors (`loo`), how it was built (`summary`),
        what to know (`warnings`), and how each value is known (`coverage`, see `COVERAGE`).

    Raises
    ------
    QuantityError
        The channel is not in the measurement, or not named among several.
    FitError
        Fewer than two incidences, or readings that do not span a hemisphere.
    DomainError
        An option outside its choices.
    """
    return _native.build(
        measurement._data, channel=channel, symmetry=symmetry, smooth=smooth, candidate=candidate
    )
