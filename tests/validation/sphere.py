"""Virtual integrating spheres against the balance of their flux and integrals of the model."""

from __future__ import annotations

from dataclasses import dataclass

import gonio
from gonio import _native
from gonio.spheres import Sphere, parse_sphere

TEXT = """
format = "gonio-sphere 1"
name = "validation"
arrangement = "{arrangement}"
method = "{method}"
theta_i = 8.0
[sphere]
diameter_mm = 300.0
wall = {wall}
[beam]
diameter_mm = 10.0
[sample]
diameter_mm = {sample}
{entrance}
[trap]
diameter_mm = {trap}
[detector]
theta = 90.0
phi = 90.0
diameter_mm = {detector}
reflectance = 0.05
[comparison]
theta = 110.0
phi = 270.0
diameter_mm = {sample}
[auxiliary]
theta = 60.0
phi = 200.0
diameter_mm = 12.0
{baffle}
"""

ENTRANCE = """[entrance]
diameter_mm = 25.0
[standard]
reflectance = 0.98"""

BAFFLE = """[[baffle]]
between = ["sample", "detector"]
at = 0.6
diameter_mm = 60.0"""


def described(
    *,
    wall: float,
    trap: float,
    method: str,
    arrangement: str = "reflection",
    sample: float = 25.0,
    detector: float = 25.0,
    baffle: bool = True,
) -> Sphere:
    """A sphere of 300 mm; diameters of ports in mm."""
    text = TEXT.format(
        wall=wall,
        trap=trap,
        method=method,
        arrangement=arrangement,
        sample=sample,
        detector=detector,
        entrance=ENTRANCE if arrangement == "reflection" else "",
        baffle=BAFFLE if baffle else "",
    )
    return parse_sphere(text, source="validation")


def plastic(rho_d: float, s: float, alpha: float) -> gonio.Bsdf:
    """Lambert and the lobe of Radiance's plastic."""
    return _native.analytic(
        [{"model": "lambert", "rho": rho_d}, {"model": "ward-gmd", "rho": s, "alpha": alpha}]
    )


def pane(alpha: float) -> gonio.Bsdf:
    """Etched glass: diffuse to both sides, a lobe through."""
    return _native.analytic(
        [
            {"model": "lambert", "rho": 0.2},
            {"model": "lambert-transmission", "tau": 0.3},
            {"model": "bounded-transmission-lobe", "tau": 0.3, "alpha": alpha},
        ]
    )


@dataclass(frozen=True)
class Case:
    """A sphere and a plastic: diffuse reflectance, specularity, alpha."""

    wall: float
    trap: float
    method: str
    material: tuple[float, float, float]

    def measured(self, rays: int, seed: int = 1) -> gonio.SphereMeasurement:
        """What the procedure says."""
        sphere = described(wall=self.wall, trap=self.trap, method=self.method)
        return gonio.sphere(plastic(*self.material), sphere=sphere, rays=rays, seed=seed)


CASES = (
    Case(0.97, 35.0, "comparison", (0.40, 0.05, 0.005)),
    Case(0.97, 35.0, "comparison", (0.40, 0.05, 0.02)),
    Case(0.97, 50.0, "comparison", (0.40, 0.10, 0.05)),
    Case(0.97, 60.0, "comparison", (0.30, 0.20, 0.10)),
    Case(0.90, 35.0, "comparison", (0.05, 0.04, 0.03)),
    Case(0.985, 50.0, "comparison", (0.80, 0.08, 0.02)),
    Case(0.97, 35.0, "auxiliary", (0.40, 0.05, 0.02)),
    Case(0.90, 60.0, "auxiliary", (0.10, 0.10, 0.08)),
    Case(0.985, 35.0, "auxiliary", (0.60, 0.06, 0.01)),
)
"""Walls, traps, methods and plastics; of the rougher ones only a part of the lobe fits through the trap."""


@dataclass(frozen=True)
class Multiplier:
    """Multiplier of a sphere by rays with its standard error, and by the balance of flux."""

    wall: float
    ports: float
    trap_open: bool
    sample: float
    found: float
    u: float
    formula: float

    @property
    def off(self) -> float:
        """Relative difference."""
        return self.found / self.formula - 1.0


SPHERES = (
    (0.80, 25.0, 25.0),
    (0.90, 100.0, 60.0),
    (0.95, 25.0, 25.0),
    (0.97, 50.0, 40.0),
    (0.98, 25.0, 25.0),
    (0.98, 60.0, 30.0),
)
"""Wall, diameters of the sample's (and comparison) and the detector's port, mm."""


def multipliers(rays: int) -> list[Multiplier]:
    """Spheres without baffles, lit on the wall by the auxiliary lamp, with black sample and standard."""
    black, found = 0.02, []
    for wall, sample, detector in SPHERES:
        sphere = described(
            wall=wall, trap=35.0, method="auxiliary", sample=sample, detector=detector, baffle=False
        )
        native = sphere.native()
        fractions = {name: share for name, _, _, share in native.ports}
        grey = _native.analytic([{"model": "lambert", "rho": black}])
        for r in gonio.sphere(grey, sphere=sphere, rays=rays).readings:
            if r.source != "auxiliary":
                continue
            reflectance = black if r.sample else sphere.standard
            filled = {
                "sample": reflectance,
                "comparison": wall,
                "detector": 0.05,
                "trap": 0.0 if r.trap_open else wall,
            }
            formula = native.multiplier(first=wall, filled=filled)
            scale = fractions["detector"]
            ports = sum(fractions.values())
            found.append(
                Multiplier(wall, ports, r.trap_open, reflectance, r.value / scale, r.u / scale, formula)
            )
    return found
