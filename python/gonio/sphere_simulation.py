"""The virtual integrating sphere: what a sphere with a gloss trap says of a material."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, TypeAlias

from gonio._native import Bsdf, DomainError, IntegratingSphere, RenderWatch
from gonio.building import build
from gonio.checking import MeasurementOrPath
from gonio.fit_spheres import SphereReading, SphereReadings
from gonio.materials import MATERIALS, Material
from gonio.measurement import Measurement
from gonio.readings import PathLike
from gonio.shown_models import shown_model
from gonio.spheres import METHODS, Sphere, read_sphere
from gonio.working import Progress, interruptible, silent

Sample: TypeAlias = Bsdf | Material | MeasurementOrPath
"""What a sphere measures: a model, a material, a measurement, or the name or file of one."""

FIRST_RAYS = 2**16
"""Rays of each reading by which is found how many an error needs."""

MOST_RAYS = 2**26
"""Rays of each reading, at most."""


@dataclass(frozen=True)
class SphereValue:
    """A value with its standard uncertainty `u`, of which `u_rays` comes from the rays that were followed."""

    value: float
    u: float
    u_rays: float


@dataclass(frozen=True)
class SphereFlux:
    """One reading of the detector: share of the lamp's flux that reaches it.

    `source` is beam or auxiliary; `sample` whether the sample is measured (otherwise the standard, in
    transmission the open port).
    """

    source: str
    sample: bool
    trap_open: bool
    value: float
    u: float


@dataclass(frozen=True)
class SphereMeasurement:
    """What a virtual integrating sphere says of a material.

    Attributes
    ----------
    sphere, arrangement, method, theta_i, phi_i, channel
        What measured, how, and what: angles of incidence in degrees.
    total
        Reflectance (transmittance) of the sample into the hemisphere.
    diffuse
        Its part outside the trap's cone: the total less `port`.
    port
        Its part through the trap, diffuse light in the cone included.
    specularity
        What is called the specular or regular part: `(port - F total) / (1 - F)`, as of a mirror on a
        Lambertian ground.
    plain_total, plain_specularity
        The same by bare ratios of readings: with the error that the sample's change of the sphere makes
        (substitution), and without the correction for light that meets ports first.
    diffuse_share
        F: share of Lambertian light that leaves through the trap.
    half_angle
        Half angle in degrees of the round cone about the mirrored (unbent) direction that takes that share.
    model_total, model_port
        The same of the model by integration; `model_port` over the true cone of the trap.
    readings
        Readings of the detector.
    rays
        Rays of each reading.
    warnings
        What to know.

    Values of the trap are None for a sphere without one.
    """

    sphere: str
    arrangement: str
    method: str
    theta_i: float
    phi_i: float
    channel: str
    total: SphereValue
    diffuse: SphereValue | None
    port: SphereValue | None
    specularity: SphereValue | None
    plain_total: SphereValue
    plain_specularity: SphereValue | None
    diffuse_share: float | None
    half_angle: float | None
    model_total: float
    model_port: float | None
    readings: tuple[SphereFlux, ...]
    rays: int
    warnings: list[str] = field(default_factory=list)

    @property
    def substitution_error(self) -> float:
        """How far the bare ratio of readings is off: `plain_total - total`."""
        return self.plain_total.value - self.total.value

    @property
    def reading(self) -> SphereReading:
        """What was read, as `gonio.fit` takes it; without a trap the total alone."""
        diffuse = self.diffuse
        return SphereReading(
            total=self.total.value,
            u_total=self.total.u,
            diffuse=None if diffuse is None else diffuse.value,
            u_diffuse=None if diffuse is None else diffuse.u,
            half_angle=self.half_angle,
            theta_i=self.theta_i,
            phi_i=self.phi_i,
            component=self.arrangement,
            channel=self.channel,
        )

    @property
    def readings_to_fit(self) -> SphereReadings:
        """The same with the correlation of total and diffuse, which share standard and rays."""
        return SphereReadings.of(self.reading, u_port=None if self.port is None else self.port.u)

    def write(self, path: PathLike) -> None:
        """Write the reading as a TOML file that `gonio fit --sphere` takes."""
        self.readings_to_fit.write(path)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as `gonio sphere --json` prints them."""
        return {**asdict(self), "substitution_error": self.substitution_error}


def sphere(
    sample: Sample,
    *,
    sphere: PathLike | Sphere = "reflectance-300",
    theta_i: float | None = None,
    phi_i: float = 0.0,
    channel: str | None = None,
    method: str | None = None,
    error: float = 5e-4,
    rays: int | None = None,
    seed: int = 1,
    progress: Progress = silent,
) -> SphereMeasurement:
    """Measure a material with a virtual integrating sphere, as DIN 5036-3 has it [DIN5036].

    The sample is read with the trap closed (all of its light) and open (light in the cone of the trap
    leaves), beside a standard or, in transmission, the open port. Light is followed from the lamp through the
    sphere with its ports, baffles and the sample's scattering until it is gone; docs/sphere.md says what is
    computed from the readings.

    Parameters
    ----------
    sample
        A `Bsdf`, a `Material`, a `Measurement` (of two incidences at least, from which a data-driven model is
        built), or by name or path: a material of `gonio.materials.MATERIALS`, a file of a model, a directory
        of a measurement or a fit.
    sphere
        File of a sphere (docs/formats/sphere-toml.md), one of `gonio.spheres.spheres`, or a `Sphere`.
    theta_i
        Angle of incidence in degrees in place of the sphere's; entrance and trap lie accordingly.
    phi_i
        Azimuth of incidence in the sample's frame, degrees.
    channel
        Channel of the model; may be left out where there is one.
    method
        substitution, auxiliary or comparison in place of the sphere's.
    error
        Standard error of the rays that `total` and `port` may have, 1e-6 to 0.1: more are followed until it
        is met, or there are 2**26 a reading.
    rays
        Rays of each reading, 32 times a power of two (rounded up); `error` does not count then.
    seed
        Seed of the rays; the same gives the same values on any number of threads.
    progress
        Called with a stage and how far it is.

    Raises
    ------
    DomainError
        A parameter outside its range, a sphere that cannot be built at this incidence, a method that it has
        no port for.
    FormatError, QuantityError, FitError, OSError
        As `read_sphere`, `read_bsdf` and `build`.

    Examples
    --------
    >>> found = gonio.sphere("plastic", rays=2**12)
    >>> abs(found.total.value - found.model_total) < 0.05
    True
    """
    _check("error", 1e-6 <= error <= 0.1, error, "1e-6 to 0.1")
    _check("rays", rays is None or 1 <= rays <= MOST_RAYS, rays, f"1 to {MOST_RAYS}")
    _check("seed", 0 <= seed < 2**64, seed, "0 to 2**64 - 1")
    _check("theta_i", theta_i is None or 0.0 <= theta_i <= 85.0, theta_i, "0 to 85 degrees")
    _check("phi_i", math.isfinite(phi_i), phi_i, "an angle in degrees")
    _check("method", method is None or method in METHODS, method, ", ".join(METHODS))
    described = sphere if isinstance(sphere, Sphere) else read_sphere(sphere)
    if theta_i is not None:
        described = replace(described, theta_i=float(theta_i))
    if method is not None:
        described = replace(described, method=method)
    native = described.native(phi_i=phi_i)
    model = sample_model(sample, channel=channel)

    def measured(count: int) -> SphereMeasurement:
        watch = RenderWatch()
        found = interruptible(
            lambda: native.measure(
                model,
                channel=channel,
                method=described.method,
                rays=count,
                seed=seed,
                watch=watch,
            ),
            tick=lambda: progress("rays", int(1000 * watch.progress()[0]), 1000),
            stop=watch.stop,
        )
        return _result(described, native, model, found, phi_i=phi_i, channel=channel, rays=count)

    if rays is not None:
        return measured(_rounded(rays))
    count = FIRST_RAYS
    while True:
        found = measured(count)
        most = max(v.u_rays for v in (found.total, found.port) if v is not None)
        if most <= error or count >= MOST_RAYS:
            return found
        count = min(_rounded(math.ceil(count * max(2.0, 1.1 * (most / error) ** 2))), MOST_RAYS)


def sample_model(sample: Sample, *, channel: str | None = None) -> Bsdf:
    """The model of what a sphere measures: as `sphere` takes it.

    Raises
    ------
    FormatError, QuantityError, FitError, DomainError, OSError
        As `read_bsdf` and `build`.
    """
    if isinstance(sample, Bsdf):
        return sample
    if isinstance(sample, Material):
        return sample.bsdf
    if isinstance(sample, Measurement):
        return build(sample, channel=channel)
    if not Path(sample).exists():
        if str(sample) in MATERIALS:
            return MATERIALS[str(sample)]().bsdf
        raise DomainError(
            f"sample: found {str(sample)!r}, which is no file; allowed a file or directory of a model, or "
            f"{', '.join(MATERIALS)}"
        )
    return shown_model(sample, channel=channel)


def _rounded(rays: int) -> int:
    """What the rays of a reading are rounded up to."""
    return 32 << max(0, math.ceil(math.log2(rays / 32)))


def _check(name: str, good: bool, found: object, allowed: str) -> None:
    if not good:
        raise DomainError(f"{name}: found {found}, allowed {allowed}")


def _result(
    described: Sphere,
    native: IntegratingSphere,
    model: Bsdf,
    found: dict[str, Any],
    *,
    phi_i: float,
    channel: str | None,
    rays: int,
) -> SphereMeasurement:
    def value(name: str) -> SphereValue:
        v, u = found[name]
        return SphereValue(v, math.hypot(u, v * described.u_standard), u)

    def if_there(name: str) -> SphereValue | None:
        return None if found[name] is None else value(name)

    total, port = native.integrals(model, channel=channel)
    return SphereMeasurement(
        sphere=described.name,
        arrangement=described.arrangement,
        method=described.method,
        theta_i=described.theta_i,
        phi_i=phi_i,
        channel=channel or model.channels[0],
        total=value("total"),
        diffuse=if_there("diffuse"),
        port=if_there("port"),
        specularity=if_there("regular"),
        plain_total=value("plain_total"),
        plain_specularity=if_there("plain_regular"),
        diffuse_share=found["diffuse_share"],
        half_angle=found["half_angle"],
        model_total=total,
        model_port=port,
        readings=tuple(SphereFlux(*row) for row in found["readings"]),
        rays=rays,
        warnings=_warnings(described, found),
    )


def _warnings(described: Sphere, found: dict[str, Any]) -> list[str]:
    said = []
    if described.method == "substitution":
        said.append(
            "the sample changes the sphere and nothing corrects for it (substitution): measure with an "
            "auxiliary lamp, or sample and standard at once (comparison)"
        )
    ports: Sequence[frozenset[str]] = [frozenset(b[:2]) for b in described.baffles]
    if frozenset(("sample", "detector")) not in ports:
        said.append("no baffle between sample and detector: light of the sample reaches the detector at once")
    if found["port"] is not None and abs(found["port"][0]) < 4.0 * found["port"][1]:
        said.append("the light through the trap is less than four standard errors of the rays: follow more")
    return said
