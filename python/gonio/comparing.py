"""Two models or measurements side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from gonio import _native
from gonio._native import Bsdf, DomainError, QuantityError
from gonio.building import build
from gonio.checking import loaded
from gonio.measurement import Measurement
from gonio.model_files import read_bsdf
from gonio.readings import PathLike
from gonio.working import Progress, interruptible, silent

ModelOrMeasurement: TypeAlias = Bsdf | Measurement | PathLike
"""A model, a file of one, a measurement, or the directory of a saved one."""

THETA_I = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)
"""Degrees from the normal of the lit side: the incidences of a comparison unless others are given."""

Job: TypeAlias = tuple[tuple[str, str], str, str, float, float]
"""Channels of a and b, side, component, theta_i and phi_i."""

PHI_I = (0.0, 45.0, 90.0, 135.0)
KEYS = [(s, c) for s in ("front", "back") for c in ("reflection", "transmission")]


@dataclass(frozen=True)
class ComparedIncidence:
    """Model b against model a at one incidence, channel and component.

    Attributes
    ----------
    theta_i, phi_i
        Incidence, degrees; above 90 the back is lit.
    rel_l1
        Integral of |f_b - f_a| cos over that of f_a cos, scattered light alone.
    rel_rms
        Root of the integral of (DSF_b - DSF_a)² over that of DSF_a².
    dhr_a, dhr_b
        Directional-hemispherical reflectance or transmittance, light without spread included.
    ideal_a, ideal_b
        Share of the light that leaves without spread (mirror, unbent); of a table, what its cells hold of
        that of the other model.
    peak_a, peak_b
        Largest DSF, 1/sr.
    peak_shift
        Angle between the directions of the largest DSF, degrees.
    reciprocity_a, reciprocity_b
        Mean relative difference of f from f with the directions swapped; 0 for a reciprocal model, NaN where
        nothing is known of light that comes the other way (transmission measured from one side).
    """

    channel: str
    side: str
    component: str
    theta_i: float
    phi_i: float
    rel_l1: float
    rel_rms: float
    dhr_a: float
    dhr_b: float
    ideal_a: float
    ideal_b: float
    peak_a: float
    peak_b: float
    peak_shift: float
    reciprocity_a: float
    reciprocity_b: float

    @property
    def peak_ratio(self) -> float:
        """Largest DSF of b over that of a; NaN where a is dark."""
        return self.peak_b / self.peak_a if self.peak_a > 0.0 else math.nan


@dataclass(frozen=True)
class ModelComparison:
    """Two models, incidence by incidence.

    Attributes
    ----------
    rows
        The incidences.
    a, b
        The models.
    channels
        Pairs of channels that were compared, of a and of b.
    warnings
        What to know: components that only one of them has.
    """

    rows: list[ComparedIncidence]
    a: Bsdf
    b: Bsdf
    channels: list[tuple[str, str]]
    warnings: list[str] = field(default_factory=list)

    @property
    def summary(self) -> dict[tuple[str, str, str], dict[str, float]]:
        """By (channel, side, component): see `summarised`."""
        keys = list(dict.fromkeys((r.channel, r.side, r.component) for r in self.rows))
        return {k: summarised([r for r in self.rows if (r.channel, r.side, r.component) == k]) for k in keys}

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as `gonio compare --json` prints them."""
        return {
            "rows": [asdict(r) | {"peak_ratio": r.peak_ratio} for r in self.rows],
            "summary": [
                {"channel": channel, "side": side, "component": component} | values
                for (channel, side, component), values in self.summary.items()
            ],
            "warnings": self.warnings,
        }


def summarised(rows: Sequence[ComparedIncidence]) -> dict[str, float]:
    """What some incidences have in common.

    Returns
    -------
    dict
        rel_l1 (mean), rel_l1_max, rel_rms (mean), dhr_difference (of b from a where they differ most),
        ideal_a, ideal_b (means), ideal_difference (of b from a where they differ most),
        peak_ratio (farthest from 1), peak_shift (largest, degrees), reciprocity_a, reciprocity_b (means). NaN
        where there is nothing.
    """

    def finite(name: str) -> list[float]:
        return [v for v in (getattr(r, name) for r in rows) if math.isfinite(v)]

    def mean(name: str) -> float:
        values = finite(name)
        return sum(values) / len(values) if values else math.nan

    ratios = [v for v in finite("peak_ratio") if v > 0.0]
    return {
        "rel_l1": mean("rel_l1"),
        "rel_l1_max": max(finite("rel_l1"), default=math.nan),
        "rel_rms": mean("rel_rms"),
        "dhr_difference": max((r.dhr_b - r.dhr_a for r in rows), key=abs, default=math.nan),
        "ideal_a": mean("ideal_a"),
        "ideal_b": mean("ideal_b"),
        "ideal_difference": max((r.ideal_b - r.ideal_a for r in rows), key=abs, default=math.nan),
        "peak_ratio": max(ratios, key=lambda v: abs(math.log(v)), default=math.nan),
        "peak_shift": max(finite("peak_shift"), default=math.nan),
        "reciprocity_a": mean("reciprocity_a"),
        "reciprocity_b": mean("reciprocity_b"),
    }


def compare(
    a: ModelOrMeasurement,
    b: ModelOrMeasurement,
    *,
    channel: str | None = None,
    channel_b: str | None = None,
    components: Sequence[tuple[str, str]] | None = None,
    incidences: Sequence[tuple[float, float]] | None = None,
    progress: Progress = silent,
) -> ModelComparison:
    """Compare two models: what `b` gets wrong when `a` is right.

    A measurement takes part as the data-driven model that `gonio.build` makes of it. Directions are dense
    about the mirror and the unbent direction; lobes there narrower than about 0.5 degrees, and others
    narrower than about 1 degree, are not resolved. Scattered light is compared with scattered light, and the
    ideal parts (mirror, unbent) with each other; where one model is a table without such a part, the light
    that its cells in the ideal direction hold beyond the scattered light of the other counts as one.

    Parameters
    ----------
    a, b
        Models, files of models, measurements or directories of saved ones.
    channel
        Channel of both; None compares all that they have in common, or the only one of each.
    channel_b
        Channel of `b`, where it has another name than that of `a`: a Radiance file is labelled photopic
        whatever it was measured in.
    components
        Side of incidence and component; None takes all in which one of them scatters.
    incidences
        (theta_i, phi_i) in degrees; above 90 the back is lit. None takes `THETA_I` from the normal of every
        lit side, at four azimuths unless both are isotropic.
    progress
        Called with stage, parts done and parts in all.

    Raises
    ------
    QuantityError
        No common channel, or not the one asked for; a component in which neither scatters.
    DomainError
        An incidence on the horizon or out of range, or no component in which one of them scatters.
    FitError, FormatError, OSError
        A measurement that no model can be built from, or a file that cannot be read.
    """
    first = model_of(a, channel=channel, progress=progress)
    second = model_of(b, channel=channel if channel_b is None else channel_b, progress=progress)
    channels = _channels(first, second, channel, channel_b)
    lit = {k: [scatters(m, *k) for m in (first, second)] for k in KEYS}
    asked = list(components) if components is not None else [k for k in KEYS if any(lit[k])]
    if not asked or any(k not in KEYS for k in asked):
        found = ", ".join("-".join(k) for k in asked) or "none that scatters"
        raise DomainError(f"components: found {found}, allowed {', '.join('-'.join(k) for k in KEYS)}")
    dark = ["-".join(k) for k in asked if not any(lit[k])]
    if dark:
        there = ", ".join("-".join(k) for k in KEYS if any(lit[k])) or "none"
        raise QuantityError(
            f"components: found {', '.join(dark)}, where neither scatters, needed some of {there}"
        )
    warnings = [
        f"{side} {component}: only {'a' if lit[side, component][0] else 'b'} scatters there"
        for side, component in asked
        if sum(lit[side, component]) == 1
    ]
    isotropic = first.properties["isotropic"] and second.properties["isotropic"]
    at = _incidences(incidences, isotropic=isotropic)
    jobs: list[Job] = [
        (pair, *key, theta, phi) for pair in channels for key in asked for theta, phi in at[key[0]]
    ]
    if not jobs:
        found = ", ".join(f"({t:g}, {p:g})" for t, p in incidences or ())
        raise DomainError(f"incidences: found {found}, none on a side that scatters, allowed one at least")
    rows = []
    for done, job in enumerate(jobs):
        progress("comparing", done, len(jobs))
        rows.append(_at(first, second, job))
    progress("comparing", len(jobs), len(jobs))
    return ModelComparison(rows=rows, a=first, b=second, channels=channels, warnings=warnings)


def _incidences(
    given: Sequence[tuple[float, float]] | None, *, isotropic: bool
) -> dict[str, list[tuple[float, float]]]:
    """(theta_i, phi_i) by side of incidence."""
    if given is None:
        phis = PHI_I[:1] if isotropic else PHI_I
        front = [(t, p) for t in THETA_I for p in phis]
        return {"front": front, "back": [(180.0 - t, p) for t, p in front]}
    for theta, phi in given:
        if not (0.0 <= theta <= 180.0 and theta != 90.0 and math.isfinite(phi)):
            raise DomainError(
                f"incidences: found ({theta:g}, {phi:g}), "
                "allowed theta_i of 0 to 180 degrees but 90, finite phi_i"
            )
    return {
        "front": [(float(t), float(p)) for t, p in given if t < 90.0],
        "back": [(float(t), float(p)) for t, p in given if t > 90.0],
    }


def model_of(
    source: ModelOrMeasurement,
    *,
    channel: str | None = None,
    direct: bool = True,
    progress: Progress = silent,
) -> Bsdf:
    """The model itself, that of a file, or the data-driven one of a measurement in all of its channels.

    `direct` is that of `gonio.build`.

    Raises
    ------
    QuantityError, FitError, FormatError, OSError
        As `read_bsdf` and `build`.
    """
    if isinstance(source, Bsdf):
        return source
    if not isinstance(source, Measurement) and not Path(source).is_dir():
        return read_bsdf(source, channel=channel)
    sample = loaded(source)
    if channel is not None or len(sample.channels) == 1:
        return build(sample, channel=channel, direct=direct, progress=progress)
    return _native.side_by_side(
        [build(sample, channel=c, direct=direct, progress=progress) for c in sample.channels]
    )


def _channels(a: Bsdf, b: Bsdf, channel: str | None, channel_b: str | None) -> list[tuple[str, str]]:
    if channel is not None or channel_b is not None:
        return [(_named(a, channel), _named(b, channel if channel_b is None else channel_b))]
    common = [c for c in a.channels if c in b.channels]
    if common:
        return [(c, c) for c in common]
    if len(a.channels) == len(b.channels) == 1:
        return [(a.channels[0], b.channels[0])]
    raise QuantityError(
        f"channel: found {', '.join(a.channels)} and {', '.join(b.channels)}, needed one in common, "
        "or one of each: --channel and --channel-b (channel=, channel_b=)"
    )


def _named(model: Bsdf, channel: str | None) -> str:
    """The channel of that name, or the only one."""
    if channel is None and len(model.channels) == 1:
        return model.channels[0]
    for name in model.channels:
        if channel is not None and name in (channel, f"{channel}nm"):
            return name
    raise QuantityError(f"channel: found {channel or 'none'}, needed one of {', '.join(model.channels)}")


def scatters(model: Bsdf, side: str, component: str) -> bool:
    """Whether light that arrives on `side` goes into `component`, at any of some directions."""
    for theta in (5.0, 40.0, 70.0):
        up = (component == "reflection") == (side == "front")
        at = theta if side == "front" else 180.0 - theta
        seen = [t if up else 180.0 - t for t in (0.0, 10.0, 40.0, 70.0, theta)]
        for c in model.channels:
            if model.delta(theta_i=at, phi_i=0.0, component=component, channel=c)["share"] > 0.0:
                return True
            f = model.eval(
                theta_i=at,
                phi_i=0.0,
                theta_s=[[t] for t in seen],
                phi_s=[0.0, 60.0, 120.0, 180.0],
                channel=c,
            )
            if (f > 0.0).any():
                return True
    return False


def _at(a: Bsdf, b: Bsdf, job: Job) -> ComparedIncidence:
    channels, side, component, theta, phi = job
    found = interruptible(
        lambda: _native.compare_models(
            a,
            b,
            theta_i=theta,
            phi_i=phi,
            component=component,
            channel_a=channels[0],
            channel_b=channels[1],
        )
    )
    return ComparedIncidence(
        channel=channels[0],
        side=side,
        component=component,
        theta_i=theta,
        phi_i=phi,
        rel_l1=found["rel_l1"],
        rel_rms=found["rel_rms"],
        dhr_a=found["albedo_a"],
        dhr_b=found["albedo_b"],
        ideal_a=found["ideal_a"],
        ideal_b=found["ideal_b"],
        peak_a=found["peak_a"],
        peak_b=found["peak_b"],
        peak_shift=found["peak_shift"],
        reciprocity_a=found["reciprocity_a"],
        reciprocity_b=found["reciprocity_b"],
    )


def reciprocity_text(value: float) -> str:
    """A reciprocity as it is printed: per cent, or why there is none."""
    return f"{100 * value:.2f} %" if math.isfinite(value) else "unknown (one side measured)"
