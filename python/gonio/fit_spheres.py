"""Readings of an integrating sphere as data of a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gonio import _native
from gonio._native import DomainError, FormatError
from gonio.files import check_file, replacing_file
from gonio.fit_results import Fit, fit_of
from gonio.instrument_keys import Key, Number, Section, Word, parse_toml
from gonio.provenance import input_file, provenance
from gonio.readings import PathLike
from gonio.working import interruptible

FORMAT = "gonio-sphere-readings 1"

MOST_APART, MOST_ALIKE = -0.99, 0.9999
"""Correlations that a covariance with an inverse may have."""

KEYS: Mapping[str, Mapping[str, Key]] = {
    "": {
        "format": Word((FORMAT,)),
        "correlation": Number(MOST_APART, MOST_ALIKE, 0.0),
        "reading": Section(many=True),
    },
    "reading": {
        "theta_i": Number(0.0, 85.0, 8.0),
        "phi_i": Number(-360.0, 360.0, 0.0),
        "component": Word(("reflection", "transmission"), required=False),
        "channel": Word(required=False),
        "total": Number(0.0, 1.2, required=False),
        "u_total": Number(1e-6, 1.0, required=False),
        "diffuse": Number(0.0, 1.2, required=False),
        "u_diffuse": Number(1e-6, 1.0, required=False),
        "half_angle": Number(0.1, 60.0, required=False),
    },
}
"""Keys of a file of readings with what they allow."""

ALONE = "photopic"
"""Channel of readings that name none, where there is nothing else to say it."""


@dataclass(frozen=True)
class SphereReading:
    """What a sphere read of a sample at one incidence.

    Attributes
    ----------
    total, u_total
        Reflectance (transmittance) with the trap closed, and its standard uncertainty; None if not read.
    diffuse, u_diffuse
        The same with the trap open: all light but that in the trap's cone.
    half_angle
        Half angle of that cone about the mirrored (unbent) direction, degrees; needed with `diffuse`.
    theta_i, phi_i
        Incidence, degrees.
    component
        reflection or transmission.
    channel
        Name of the channel; None: the only one there is.
    """

    total: float | None = None
    u_total: float | None = None
    diffuse: float | None = None
    u_diffuse: float | None = None
    half_angle: float | None = None
    theta_i: float = 8.0
    phi_i: float = 0.0
    component: str = "reflection"
    channel: str | None = None


@dataclass(frozen=True)
class SphereReadings:
    """Readings of a sphere; `correlation` is that of each two values, as of a common standard."""

    readings: tuple[SphereReading, ...]
    correlation: float = 0.0
    source: str = ""

    def native(self, *, channels: Sequence[str]) -> tuple[list[tuple[Any, ...]], list[float]]:
        """Rows of the core with their covariance; readings without a channel belong to the only one.

        Raises
        ------
        DomainError
            No readings, a value without its uncertainty, a diffuse one without the trap's cone, no channel
            named among several.
        """
        rows: list[tuple[Any, ...]] = []
        u: list[float] = []
        for k, r in enumerate(self.readings):
            where = f"{self.source or 'sphere'}: reading {k + 1}"
            channel = r.channel
            if channel is None:
                if len(channels) != 1:
                    raise DomainError(f"{where}: channel: found none, allowed one of {', '.join(channels)}")
                channel = channels[0]
            before = len(rows)
            for part, value, error in (
                ("total", r.total, r.u_total),
                ("diffuse", r.diffuse, r.u_diffuse),
            ):
                if value is None:
                    continue
                if error is None or not error > 0.0:
                    raise DomainError(
                        f"{where}: u_{part}: found {error}, allowed a standard uncertainty above 0"
                    )
                if part == "diffuse" and r.half_angle is None:
                    raise DomainError(
                        f"{where}: half_angle: found none, allowed the half angle of the open port's cone"
                    )
                half = 0.0 if part == "total" else float(r.half_angle or 0.0)
                rows.append((channel, (r.theta_i, r.phi_i), r.component, part, half, float(value)))
                u.append(float(error))
            if len(rows) == before:
                raise DomainError(f"{where}: found neither total nor diffuse, allowed one or both")
        if not rows:
            raise DomainError(f"{self.source or 'sphere'}: found no reading, allowed at least one")
        covariance = self.correlation * np.outer(u, u)
        np.fill_diagonal(covariance, np.square(u))
        return rows, [float(c) for c in covariance.ravel()]

    @classmethod
    def of(cls, reading: SphereReading, *, u_port: float | None = None) -> SphereReadings:
        """One reading; `u_port`, the uncertainty of total less diffuse, tells how the two are correlated."""
        correlation = 0.0
        if u_port is not None and reading.u_total and reading.u_diffuse:
            shared = reading.u_total**2 + reading.u_diffuse**2 - u_port**2
            correlation = shared / (2.0 * reading.u_total * reading.u_diffuse)
        return cls((reading,), correlation=min(max(correlation, MOST_APART), MOST_ALIKE))

    def write(self, path: PathLike) -> None:
        """Write the TOML file that `read_sphere_readings` reads; it appears whole or not at all."""
        check_file(path)
        lines = [f'format = "{FORMAT}"', f"correlation = {self.correlation!r}"]
        for r in self.readings:
            lines += ["", "[[reading]]"]
            for key in KEYS["reading"]:
                value = getattr(r, key)
                if value is not None:
                    lines.append(f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value!r}")
        with replacing_file(path) as staged:
            staged.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_sphere_readings(path: PathLike) -> SphereReadings:
    """Read a file of sphere readings (docs/formats/sphere-toml.md).

    Raises
    ------
    FormatError
        Not TOML, an unknown or missing key, a value out of its range: the message names file and key.
    OSError
        The file cannot be read.
    """
    source = str(path)
    text = Path(path).read_bytes().decode("utf-8", errors="replace")
    raw = parse_toml(text, source=source, kind=FORMAT)

    def section(name: str, given: Mapping[str, Any]) -> dict[str, Any]:
        for key in given:
            if key not in KEYS[name]:
                allowed = ", ".join(KEYS[name])
                raise FormatError(f"{source}: {key}: found an unknown key, allowed {allowed}")
        found = {}
        for key, kind in KEYS[name].items():
            if key not in given:
                if kind.required:
                    raise FormatError(f"{source}: {key}: found nothing, allowed {kind.allowed}")
                found[key] = kind.default
            elif not kind.holds(given[key]):
                raise FormatError(f"{source}: {key}: found {given[key]!r}, allowed {kind.allowed}")
            else:
                found[key] = given[key]
        return found

    top = section("", raw)
    rows = [section("reading", row) for row in top["reading"]]
    for row in rows:
        row["component"] = row["component"] or "reflection"
    found = SphereReadings(
        tuple(SphereReading(**row) for row in rows), correlation=float(top["correlation"]), source=source
    )
    try:
        found.native(channels=[ALONE])
    except DomainError as error:
        raise FormatError(str(error)) from None
    return found


def loaded_readings(readings: SphereReadings | PathLike) -> SphereReadings:
    """The readings, read from their file where a path is given."""
    return readings if isinstance(readings, SphereReadings) else read_sphere_readings(readings)


def fit_sphere(
    readings: SphereReadings | PathLike,
    *,
    model: str = "plastic",
    fixed: Mapping[str, float] | None = None,
) -> Fit:
    """Fit a model to readings of an integrating sphere alone.

    A sphere fixes few parameters: hold the others, such as the width of the lobe from a surface profile
    (`gonio.roughness`). Two readings give colour and specularity of a plastic; with cones of two sizes the
    width may be free, too. The model is integrated over the hemisphere and over the cone of each reading, so
    the specularity is that of the whole lobe, not of what the port takes.

    Parameters
    ----------
    readings
        What was read, or its file (docs/formats/sphere-toml.md).
    model
        A name of `fit_models`.
    fixed
        Parameters held at a value, by name (angles in degrees).

    Returns
    -------
    Fit
        Without residuals and predictions; `sphere` compares every reading with the model.

    Raises
    ------
    FitError
        More free parameters than readings, or no minimum.
    DomainError
        An unknown model or parameter, a value out of range.
    FormatError, OSError
        A file cannot be read.

    Examples
    --------
    >>> read = SphereReading(total=0.45, u_total=0.002, diffuse=0.40, u_diffuse=0.002, half_angle=5.0)
    >>> found = fit_sphere(SphereReadings((read,)), fixed={"alpha": 0.02})
    >>> found.estimate("specularity").value > 0.04
    True
    """
    data = loaded_readings(readings)
    named = {r.channel for r in data.readings if r.channel is not None}
    settings = {
        "fixed": {name: float(value) for name, value in (fixed or {}).items()},
        "sphere": data.native(channels=[next(iter(named)) if len(named) == 1 else ALONE]),
    }
    found = interruptible(lambda: _native.fit_sphere(model=model, settings=settings))
    inputs = (
        [{"name": data.source or "sphere readings", "role": "sphere"}]
        if isinstance(readings, SphereReadings)
        else [input_file(Path(readings), role="sphere")]
    )
    return fit_of(
        found, held_out=[], provenance=provenance(inputs=inputs, settings={"model": model} | settings)
    )
