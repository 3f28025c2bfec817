"""How far a measurement of a known material is from the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gonio._native import FLAGS, UNUSABLE, DomainError, Slice
from gonio.materials import Material
from gonio.measurement import Measurement

COVERAGE_FACTOR = 1.96
"""Half width of a 95 % interval in standard uncertainties of a normal distribution."""

DHR_LIMIT = 0.01
"""Largest relative expanded uncertainty of a DHR, and largest median error of the DSF, of a good demo."""

COVERAGE_RANGE = (0.93, 0.97)
"""Share of readings whose 95 % interval must hold the truth."""


@dataclass(frozen=True)
class Integral:
    """One DHR or DHT against the truth; `error` and `expanded` (k = 2) are fractions of the truth."""

    theta_i: float
    phi_i: float
    side: str
    value: float
    truth: float
    error: float
    expanded: float

    @property
    def name(self) -> str:
        """DHR for the side of incidence, DHT for the other."""
        return "DHR" if (self.theta_i <= 90.0) == (self.side == "front") else "DHT"

    @property
    def held(self) -> bool:
        """Whether the truth lies within the expanded uncertainty."""
        return abs(self.error) <= self.expanded


@dataclass(frozen=True)
class Comparison:
    """A measurement against the truth, over all slices.

    The truth of a DSF value is the material's DSF at the recorded direction: what the finite beam and
    aperture smear counts as an error. The truth of a DHR or DHT is the integral of the material's DSF.

    `dsf_error_median` is the median of |DSF - truth| / truth over usable readings above the noise floor (not
    flagged negative or below_noise), `coverage_95` the share of usable readings whose interval
    DSF ± 1.96 u(DSF) holds the truth.
    """

    readings: int
    integrals: tuple[Integral, ...]
    dsf_error_median: float
    coverage_95: float

    @property
    def dhr_error_max(self) -> float:
        """Largest relative error of a DHR or DHT."""
        return max(abs(i.error) for i in self.integrals)

    @property
    def dhr_expanded_uncertainty_max(self) -> float:
        """Largest relative expanded uncertainty (k = 2) of a DHR or DHT."""
        return max(i.expanded for i in self.integrals)

    @property
    def held(self) -> bool:
        """Whether every claim holds.

        Every DHR within its stated expanded uncertainty and that within 1 %, the median DSF error within 1 %,
        93 to 97 % of the readings within their 95 % interval.
        """
        low, high = COVERAGE_RANGE
        return (
            all(i.held for i in self.integrals)
            and self.dhr_expanded_uncertainty_max <= DHR_LIMIT
            and self.dsf_error_median <= DHR_LIMIT
            and low <= self.coverage_95 <= high
        )


def compare(measurement: Measurement, *, material: Material) -> Comparison:
    """Compare a measurement with the material that was measured.

    Raises
    ------
    DomainError
        The measurement has no reading above the noise floor or no hemispherical integral.
    """
    integrals: list[Integral] = []
    errors: list[NDArray[np.float64]] = []
    inside: list[NDArray[np.bool_]] = []
    for s in measurement.slices:
        error, held = _readings(s, material)
        errors.append(error)
        inside.append(held)
        integrals += _integrals(s, material)
    error = np.concatenate(errors) if errors else np.empty(0)
    if not error.size or not integrals:
        raise DomainError(
            f"measurement: found {error.size} readings above the noise floor and {len(integrals)} "
            "hemispherical integrals, allowed at least one of each"
        )
    return Comparison(
        readings=sum(len(s) for s in measurement.slices),
        integrals=tuple(integrals),
        dsf_error_median=float(np.median(error)),
        coverage_95=float(np.mean(np.concatenate(inside))),
    )


def _readings(s: Slice, material: Material) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Relative errors above the noise floor, and which usable readings hold the truth."""
    truth = material.dsf(theta_i=s.theta_i, phi_i=s.phi_i, theta_s=s.theta_s, phi_s=s.phi_s)
    deviation = np.abs(s.dsf - truth)
    usable = (s.flags & UNUSABLE) == 0
    clear = usable & ((s.flags & (FLAGS["negative"] | FLAGS["below_noise"])) == 0) & (truth > 0.0)
    # Noise that passes for a reading where hardly any light goes has an error without bound.
    with np.errstate(over="ignore"):
        relative = deviation[clear] / truth[clear]
    return relative, (deviation <= COVERAGE_FACTOR * s.u_dsf)[usable]


def _integrals(s: Slice, material: Material) -> list[Integral]:
    found = []
    for i in s.integrals:
        truth = material.directional_hemispherical(theta_i=s.theta_i, phi_i=s.phi_i, side=i.side)
        found.append(
            Integral(
                theta_i=s.theta_i,
                phi_i=s.phi_i,
                side=i.side,
                value=i.value,
                truth=truth,
                error=(i.value - truth) / truth,
                expanded=2.0 * i.u / truth,
            )
        )
    return found
