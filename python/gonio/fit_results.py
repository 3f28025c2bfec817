"""What a fit of an analytic model found, as plain data."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gonio._native import Bsdf, DomainError, FitData
from gonio.fit_parameters import Estimate

NOTABLE = 0.8
"""Correlations from this size on are worth knowing."""

SHOWN = 6
"""Estimates in the short text of a fit."""


@dataclass(frozen=True)
class SliceResidual:
    """How well the model describes one slice and component.

    `chi2` is the median squared residual over its expectation for the stated noise, `relative_l1` is
    `sum |prediction - dsf| omega / sum |dsf| omega`, `bias` the same with signs, `peak_ratio` the highest
    prediction over the highest reading. `slice` counts the slices of the measurement from 0.
    """

    slice: int
    theta_i: float
    phi_i: float
    channel: str
    component: str
    readings: int
    chi2: float
    relative_l1: float
    bias: float
    peak_ratio: float


@dataclass(frozen=True)
class HeldOut:
    """Error at an incidence that the fit did not see: the mean `relative_l1` of its residuals."""

    theta_i: float
    phi_i: float
    relative_l1: float
    residuals: tuple[SliceResidual, ...]


@dataclass(frozen=True)
class FitWarning:
    """Something to know before the parameters are used; docs/fit.md explains each `code`."""

    code: str
    text: str


@dataclass(frozen=True)
class LargestAlbedo:
    """The largest directional albedo (DHR + DHT) of a fitted model at the measured incidences.

    `u` is its standard uncertainty from the covariance of the parameters.
    """

    value: float
    u: float
    theta_i: float
    phi_i: float
    channel: str


@dataclass(frozen=True)
class SphereResidual:
    """A reading of an integrating sphere beside what the fitted model says.

    `part` is total (all light), diffuse (all but the cone of `half_angle` degrees about the mirrored or
    unbent direction) or port (that cone). `before` and `u_before` are what the model fitted to everything
    else says, and its standard uncertainty; None where there was nothing else.
    """

    channel: str
    theta_i: float
    phi_i: float
    component: str
    part: str
    half_angle: float | None
    value: float
    u: float
    predicted: float
    before: float | None
    u_before: float | None


@dataclass(frozen=True)
class Correlation:
    """Two estimates, by label, that are correlated by `value`."""

    first: str
    second: str
    value: float


@dataclass(frozen=True, repr=False)
class Fit:
    """A fitted model with everything that is known about it.

    Attributes
    ----------
    model, title
        Name and title of the model.
    channels
        In the order of the parameters.
    estimates
        The parameters; those of several channels follow one another.
    covariance, correlation
        (n, n) of the estimates; zero for those without uncertainty.
    other_metrics
        Values that other metrics prefer, in the order of `estimates`, by name of the metric.
    metric, loss, weights
        What was minimised.
    readings, excluded
        Readings that took part, and how many did not for which reason.
    blocks
        Readings that count as independent in the comparison of models.
    cost, dispersion, design_effect, aicc
        At the minimum; the dispersion is the mean squared residual in units of the stated uncertainty, None
        for metrics without one.
    evaluations, converged
        How the search went.
    residuals
        One a slice and component.
    predicted
        DSF in 1/sr as the instrument sees it, one array a slice; NaN where a reading did not take part.
    held_out
        Errors at each incidence from a fit to the others; empty when not asked for or with one incidence.
    albedo
        The largest albedo at the measured incidences; None where the model refuses its parameters.
    sphere
        Readings of an integrating sphere that took part, each with the cone it refers to.
    warnings
        What to know before the parameters are used.
    parts
        The sum as `gonio.analytic` takes it.
    provenance
        Input, versions, settings and time.
    ranking
        How the model compares with others, where several were fitted.
    """

    model: str
    title: str
    channels: tuple[str, ...]
    estimates: tuple[Estimate, ...]
    covariance: NDArray[np.float64]
    correlation: NDArray[np.float64]
    other_metrics: Mapping[str, tuple[float, ...]]
    metric: str
    loss: str
    weights: str
    readings: int
    excluded: Mapping[str, int]
    blocks: int
    cost: float
    dispersion: float | None
    design_effect: float
    aicc: float
    evaluations: int
    converged: bool
    residuals: tuple[SliceResidual, ...]
    predicted: tuple[NDArray[np.float64], ...]
    held_out: tuple[HeldOut, ...]
    albedo: LargestAlbedo | None
    warnings: tuple[FitWarning, ...]
    parts: tuple[Mapping[str, Any], ...]
    provenance: Mapping[str, Any]
    ranking: Ranking | None = None
    sphere: tuple[SphereResidual, ...] = ()
    _data: FitData | None = field(default=None, repr=False, compare=False)

    def __repr__(self) -> str:
        values = ", ".join(f"{e.label} {e.value:.4g}" for e in self.estimates[:SHOWN])
        more = f", {len(self.estimates) - SHOWN} more" if len(self.estimates) > SHOWN else ""
        error = self.held_out_error
        left_out = "" if error is None else f", left-out error {100.0 * error:.3g} %"
        ranked = "" if self.ranking is None else f", best of {len(self.ranking.fits)}"
        return f"<Fit {self.model}: {values}{more}; {self.readings} readings{left_out}{ranked}>"

    @property
    def parameters(self) -> dict[str, dict[str, float]]:
        """The values of each channel by name; angles are degrees."""
        return {c: {e.name: e.value for e in self.estimates if e.channel in (None, c)} for c in self.channels}

    @property
    def held_out_error(self) -> float | None:
        """Mean of the errors at left-out incidences, None without any."""
        errors = [h.relative_l1 for h in self.held_out]
        return float(np.mean(errors)) if errors else None

    @property
    def noise_ratio(self) -> float:
        """Typical residual in units of the stated noise: the root of the median `chi2` of slices."""
        chi2 = [r.chi2 for r in self.residuals]
        return float(np.sqrt(np.nanmedian(chi2))) if chi2 else math.nan

    @property
    def notable_correlations(self) -> tuple[Correlation, ...]:
        """Pairs of estimates whose correlation exceeds `NOTABLE` in size, strongest first."""
        first, second = np.nonzero(np.triu(np.abs(self.correlation) >= NOTABLE, k=1))
        pairs = [
            Correlation(self.estimates[a].label, self.estimates[b].label, float(self.correlation[a, b]))
            for a, b in zip(first, second, strict=True)
        ]
        return tuple(sorted(pairs, key=lambda c: -abs(c.value)))

    def estimate(self, name: str, channel: str | None = None) -> Estimate:
        """The estimate of that name, of `channel` where several channels have one each.

        Raises
        ------
        DomainError
            There is none, with the labels there are; or several channels have one and none is stated.
        """
        named = [e for e in self.estimates if e.name == name]
        if not named:
            names = ", ".join(dict.fromkeys(e.name for e in self.estimates))
            raise DomainError(f"name: found {name!r}, allowed {names}")
        found = [e for e in named if e.channel is None or channel in (e.channel, None)]
        if len(found) != 1:
            allowed = ", ".join(str(e.channel) for e in named)
            raise DomainError(f"channel: found {channel or 'none'} for {name}, allowed {allowed}")
        return found[0]

    def bsdf(self) -> Bsdf:
        """The fitted scattering model: evaluates, samples, exports."""
        from gonio.analytic import analytic  # noqa: PLC0415  (the module of `analytic` knows nothing of fits)

        return self._data.bsdf() if self._data is not None else analytic(*self.parts)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as fit.json and `gonio fit --json` hold them; without the predictions."""
        plain = {
            name: getattr(self, name)
            for name in (
                "model", "title", "metric", "loss", "weights", "readings", "blocks", "cost", "dispersion",
                "design_effect", "aicc", "evaluations", "converged", "held_out_error",
            )
        }  # fmt: skip
        return plain | {
            "channels": list(self.channels),
            "estimates": [asdict(e) for e in self.estimates],
            "parameters": self.parameters,
            "covariance": self.covariance.tolist(),
            "correlation": self.correlation.tolist(),
            "other_metrics": {k: list(v) for k, v in self.other_metrics.items()},
            "excluded": dict(self.excluded),
            "residuals": [asdict(r) for r in self.residuals],
            "held_out": [asdict(h) for h in self.held_out],
            "albedo": None if self.albedo is None else asdict(self.albedo),
            "sphere": [asdict(s) for s in self.sphere],
            "warnings": [asdict(w) for w in self.warnings],
            "parts": [dict(p) for p in self.parts],
            "provenance": dict(self.provenance),
            "ranking": None if self.ranking is None else self.ranking.to_dict(),
        }


@dataclass(frozen=True)
class Ranking:
    """Models compared on the same readings, best first.

    `fits` are those that could be fitted, `failed` tells why others could not, `passed_over` what speaks
    against models of smaller error than the first, `sentence` what the comparison says.
    """

    fits: tuple[Fit, ...]
    failed: Mapping[str, str]
    sentence: str
    passed_over: Mapping[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """One row a model: errors at left-out incidences, criterion of Akaike, where it is worst."""
        best = min(f.aicc for f in self.fits)
        return {
            "sentence": self.sentence,
            "models": [_row(f) | {"delta_aicc": _above(f.aicc, best)} for f in self.fits],
            "failed": dict(self.failed),
            "passed_over": dict(self.passed_over),
        }


def _above(aicc: float, best: float) -> float | None:
    return aicc - best if math.isfinite(aicc) else None


def _row(fit: Fit) -> dict[str, Any]:
    from gonio.fit_materials import writable  # noqa: PLC0415  (the materials are made of these results)

    worst = max(fit.held_out, key=lambda h: h.relative_l1, default=None)
    return {
        "model": fit.model,
        "title": fit.title,
        "held_out_error": fit.held_out_error,
        "aicc": fit.aicc,
        "parameters": sum(e.kind != "fixed" for e in fit.estimates),
        "dispersion": fit.dispersion,
        "worst_theta_i": None if worst is None else worst.theta_i,
        "worst_phi_i": None if worst is None else worst.phi_i,
        "worst_error": None if worst is None else worst.relative_l1,
        "values": fit.parameters,
        "warnings": [asdict(w) for w in fit.warnings],
        "materials": list(writable(fit)),
    }


def finite(value: Any) -> Any:
    """`value` with None in place of every number that JSON does not have."""
    if isinstance(value, Mapping):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [finite(v) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def fit_of(
    data: FitData,
    *,
    held_out: Sequence[Mapping[str, Any]],
    provenance: Mapping[str, Any],
    warnings: Sequence[FitWarning] = (),
    ranking: Ranking | None = None,
) -> Fit:
    """The plain data of a native fit; `warnings` follow its own."""
    n = len(data.estimates)
    return Fit(
        model=data.model,
        title=data.title,
        channels=tuple(data.channels),
        estimates=tuple(Estimate(**e) for e in data.estimates),
        covariance=np.array(data.covariance, dtype=np.float64).reshape(n, n),
        correlation=np.array(data.correlation, dtype=np.float64).reshape(n, n),
        other_metrics={k: tuple(v) for k, v in data.other_metrics.items()},
        **data.figures,
        residuals=_residuals(data.residuals),
        predicted=tuple(data.predicted),
        held_out=tuple(HeldOut(**{**h, "residuals": _residuals(h["residuals"])}) for h in held_out),
        albedo=None if data.albedo is None else LargestAlbedo(**data.albedo),
        warnings=(*(FitWarning(code, text) for code, text in data.warnings), *warnings),
        parts=tuple(data.parts),
        provenance=provenance,
        ranking=ranking,
        sphere=tuple(SphereResidual(**row) for row in data.sphere),
        _data=data,
    )


def _residuals(rows: Sequence[Mapping[str, Any]]) -> tuple[SliceResidual, ...]:
    return tuple(SliceResidual(**row) for row in rows)
