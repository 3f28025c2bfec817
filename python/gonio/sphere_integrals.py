"""What an integrating sphere would read, by integration of a measurement over the port's cone."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gonio import _native
from gonio._native import UNUSABLE, Bsdf, DomainError, QuantityError, Slice
from gonio.checking import MeasurementOrPath, loaded
from gonio.fit_spheres import SphereReading, SphereReadings
from gonio.port import diffuse_through_port

Array = NDArray[np.float64]

RINGS, SPOKES = 96, 144
"""Points of the cone: Gauss-Legendre in the square root of the solid angle, even in azimuth."""

AROUND = 1.6
"""Readings up to this many half angles from the axis are looked at, and at least `LEAST` degrees."""

LEAST = 3.0

NARROW = 3.0
"""Half angles below this many full widths of the instrument signature are too narrow for it."""


@dataclass(frozen=True)
class ConeValue:
    """A value with its standard uncertainty."""

    value: float
    u: float


@dataclass(frozen=True)
class SphereIntegrals:
    """What a sphere reads of a sample, by integration of its measured DSF.

    Attributes
    ----------
    theta_i, phi_i, channel, component
        The measured incidence in degrees, channel, and reflection or transmission.
    half_angle
        Half angle of the port's cone about the mirrored (unbent) direction, degrees.
    total
        Hemispherical integral.
    port
        Integral over the cone.
    diffuse
        Their difference: what is read with the port open.
    specularity
        `(port - F total) / (1 - F)`, with F the share of Lambertian light in the cone: what a sphere calls
        specular.
    diffuse_share
        F.
    u_readings, u_common, u_quadrature
        Parts of `port.u`: independent errors of the readings, what all share (beam power), the
        interpolation between readings.
    readings
        Readings within the cone.
    warnings
        What to know.
    """

    theta_i: float
    phi_i: float
    channel: str
    component: str
    half_angle: float
    total: ConeValue
    port: ConeValue
    diffuse: ConeValue
    specularity: ConeValue
    diffuse_share: float
    u_readings: float
    u_common: float
    u_quadrature: float
    readings: int
    warnings: list[str] = field(default_factory=list)

    @property
    def reading(self) -> SphereReading:
        """What a sphere would read, as `gonio.fit` takes it."""
        return SphereReading(
            total=self.total.value,
            u_total=self.total.u,
            diffuse=self.diffuse.value,
            u_diffuse=self.diffuse.u,
            half_angle=self.half_angle,
            theta_i=self.theta_i,
            phi_i=self.phi_i,
            component=self.component,
            channel=self.channel,
        )

    @property
    def readings_to_fit(self) -> SphereReadings:
        """The same with the correlation of total and diffuse."""
        return SphereReadings.of(self.reading, u_port=self.port.u)

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)


def sphere_integrals(
    measurement: MeasurementOrPath,
    *,
    half_angle: float,
    theta_i: float = 8.0,
    phi_i: float | None = None,
    channel: str | None = None,
    component: str = "reflection",
) -> SphereIntegrals:
    """Total, diffuse and regular reflectance (transmittance) straight from a measurement.

    The DSF is interpolated linearly on the Delaunay triangulation of the readings about the mirrored (unbent)
    direction and integrated over the port's cone; the total is the slice's hemispherical integral. As the
    integral is a weighted sum of readings, their uncertainties are propagated exactly: independent ones add
    in squares, the common one (beam power) as it is [JCGM100, eq. 13]. The difference to the integral of the
    logarithmic interpolation, where all readings are positive, counts as the uncertainty of the quadrature.

    Parameters
    ----------
    measurement
        Processed readings, or the directory they are saved in.
    half_angle
        Half the angle that the port subtends at the sample, 0.2 to 60 degrees.
    theta_i
        Angle of incidence, degrees; the measured incidence nearest to it counts, and is told.
    phi_i
        Azimuth of incidence; None takes the nearest in theta_i alone.
    channel
        Name of the channel; may be left out where there is one.
    component
        reflection or transmission.

    Raises
    ------
    DomainError
        A parameter outside its range, a cone that goes below the horizon.
    QuantityError
        No such channel; no readings all over the cone.
    FormatError, OSError
        A saved measurement cannot be loaded.
    """
    if not 0.2 <= half_angle <= 60.0:
        raise DomainError(f"half_angle: found {half_angle:g}, allowed 0.2 to 60 degrees")
    if not 0.0 <= theta_i <= 180.0:
        raise DomainError(f"theta_i: found {theta_i:g}, allowed 0 to 180 degrees")
    if component not in ("reflection", "transmission"):
        raise DomainError(f"component: found {component!r}, allowed reflection, transmission")
    data = loaded(measurement)
    found = _nearest(data.slices, data.channels, theta_i=theta_i, phi_i=phi_i, channel=channel)
    slope = min(found.theta_i, 180.0 - found.theta_i)
    if slope + half_angle >= 90.0:
        raise DomainError(
            f"half_angle: found {half_angle:g} at theta_i {found.theta_i:g}, allowed together less than 90 "
            "degrees (a port above the plane of the sample)"
        )
    reflected = component == "reflection"
    side = "front" if (found.theta_i <= 90.0) == reflected else "back"
    whole = next((i for i in found.integrals if i.side == side), None)
    if whole is None:
        raise QuantityError(f"component: found no integral of {component} at theta_i {found.theta_i:g}")
    port, u_readings, quadrature, count = _cone(found, half_angle, reflected=reflected)
    common = found.u_common * port
    u_port = math.sqrt(u_readings**2 + common**2 + quadrature**2)
    share = diffuse_through_port(theta_i=slope, half_angle=half_angle)
    total = whole.value
    # Of the total, what is not common to all readings and not the cone's.
    own = math.sqrt(max(whole.u**2 - (found.u_common * total) ** 2, 0.0))
    rest = math.sqrt(max(own**2 - u_readings**2, 0.0))

    def combined(by_port: float, by_rest: float) -> ConeValue:
        """`by_port` of the light in the cone and `by_rest` of the other."""
        value = by_port * port + by_rest * (total - port)
        own = (by_port * math.hypot(u_readings, quadrature)) ** 2 + (by_rest * rest) ** 2
        return ConeValue(value, math.sqrt(own + (found.u_common * value) ** 2))

    warnings = []
    width = data.signature_fwhm
    if width is not None and half_angle < NARROW * width:
        warnings.append(
            f"half_angle {half_angle:g} is less than {NARROW:g} widths of the instrument signature "
            f"({width:.3g} degrees): light of the peak is smeared across the edge of the cone"
        )
    if abs(found.theta_i - theta_i) > 0.5:
        warnings.append(f"no incidence at theta_i {theta_i:g}: the nearest, {found.theta_i:g}, was taken")
    return SphereIntegrals(
        theta_i=found.theta_i,
        phi_i=found.phi_i,
        channel=found.channel,
        component=component,
        half_angle=half_angle,
        total=ConeValue(total, whole.u),
        port=ConeValue(port, u_port),
        diffuse=combined(0.0, 1.0),
        specularity=combined(1.0, -share / (1.0 - share)),
        diffuse_share=share,
        u_readings=u_readings,
        u_common=abs(common),
        u_quadrature=quadrature,
        readings=count,
        warnings=warnings,
    )


def cone_integral(
    model: Bsdf,
    *,
    half_angle: float,
    theta_i: float = 8.0,
    phi_i: float = 0.0,
    component: str = "reflection",
    channel: str | None = None,
) -> float:
    """What a model sends into the round cone about the mirrored or unbent direction.

    The integral of its DSF within `half_angle` (0 to 90 degrees), its ideal part included: what leaves
    through the port of a sphere. All angles in degrees.

    Raises
    ------
    DomainError
        An angle outside its range, or no such component.
    QuantityError
        No such channel, or none named among several.
    """
    return _native.cone_integral(
        model, theta_i=theta_i, phi_i=phi_i, component=component, half_angle=half_angle, channel=channel
    )


def _nearest(
    slices: list[Slice],
    channels: list[str],
    *,
    theta_i: float,
    phi_i: float | None,
    channel: str | None,
) -> Slice:
    if channel is None and len(channels) > 1:
        raise QuantityError(f"channel (--channel): found none, needed one of {', '.join(channels)}")
    known = [s for s in slices if channel in (None, s.channel)]
    if not known:
        raise QuantityError(f"channel: found {channel!r}, needed one of {', '.join(channels)}")

    def apart(s: Slice) -> float:
        turned = 0.0 if phi_i is None else abs((s.phi_i - phi_i + 180.0) % 360.0 - 180.0)
        return abs(s.theta_i - theta_i) + 0.01 * turned

    return min(known, key=apart)


def _cone(found: Slice, half_angle: float, *, reflected: bool) -> tuple[float, float, float, int]:
    """Integral over the cone, its uncertainty from readings and from quadrature, readings in the cone."""
    # Imported here: scipy takes longer to load than all the rest of the command line.
    from scipy.spatial import Delaunay, QhullError  # noqa: PLC0415

    theta = np.radians(found.theta_s)
    phi = np.radians(found.phi_s)
    w = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    ti, pi = math.radians(found.theta_i), math.radians(found.phi_i)
    wi = np.array([math.sin(ti) * math.cos(pi), math.sin(ti) * math.sin(pi), math.cos(ti)])
    axis = np.array([-wi[0], -wi[1], wi[2]]) if reflected else -wi
    x = np.array([math.cos(ti) * math.cos(pi), math.cos(ti) * math.sin(pi), -math.sin(ti)])
    x = x - (x @ axis) * axis
    x /= np.linalg.norm(x)
    y = np.cross(axis, x)
    cos = w @ axis
    reach = math.cos(math.radians(max(AROUND * half_angle, half_angle + LEAST)))
    bad = (np.asarray(found.flags) & UNUSABLE) != 0
    near = (cos > reach) & ~bad & np.isfinite(found.dsf)

    gone = QuantityError(
        f"half_angle: found no readings all over the cone of {half_angle:g} degrees at theta_i "
        f"{found.theta_i:g}; needed readings around the mirrored or unbent direction"
    )
    d = w[near]
    # Directions about the axis in the plane, areas kept (Lambert).
    scale = np.sqrt(2.0 / (1.0 + d @ axis))
    points = np.stack([scale * (d @ x), scale * (d @ y)], axis=-1)
    if len(points) < 4:
        raise gone
    try:
        mesh = Delaunay(points)
    except QhullError:
        raise gone from None
    at, area = _nodes(half_angle)
    triangle = mesh.find_simplex(at)
    if (triangle < 0).any():
        raise gone
    transform = mesh.transform[triangle]
    two = np.einsum("nij,nj->ni", transform[:, :2], at - transform[:, 2])
    shares = np.concatenate([two, 1.0 - two.sum(axis=1, keepdims=True)], axis=1)
    corners = mesh.simplices[triangle]
    weight = np.zeros(len(points))
    np.add.at(weight, corners.ravel(), (shares * area[:, None]).ravel())
    dsf = np.asarray(found.dsf)[near]
    own = np.asarray(found.u_dsf)[near] ** 2 - (found.u_common * dsf) ** 2
    value = float(weight @ dsf)
    quadrature = 0.0
    if (dsf[weight > 0] > 0).all():
        log = np.log(np.maximum(dsf, 1e-300))
        quadrature = abs(value - float(area @ np.exp((shares * log[corners]).sum(axis=1))))
    inside = int((cos[near] >= math.cos(math.radians(half_angle))).sum())
    return value, float(np.sqrt((weight**2 * np.maximum(own, 0.0)).sum())), quadrature, inside


def _nodes(half_angle: float) -> tuple[Array, Array]:
    """Points of the cone in Lambert's plane, where the radius is sqrt(2 (1 - cos)), with solid angles."""
    nodes, weights = np.polynomial.legendre.leggauss(RINGS)
    edge = math.sqrt(2.0 * (1.0 - math.cos(math.radians(half_angle))))
    r = 0.5 * edge * (nodes + 1.0)
    chi = (np.arange(SPOKES) + 0.5) * (2.0 * np.pi / SPOKES)
    at = np.stack([np.outer(r, np.cos(chi)).ravel(), np.outer(r, np.sin(chi)).ravel()], axis=-1)
    return at, np.repeat(0.5 * edge * weights * r * (2.0 * np.pi / SPOKES), SPOKES)
