"""NIST's sintered PTFE [Germer2017]: reflectance, prediction of incidences left out, export."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gonio
from gonio import _native

from ..places import SHARED
from . import Skipped, table

FOLDER = SHARED / "nist-ptfe-mountain"
WAVELENGTHS = (351, 532, 633, 1064)
KLEMS_OF_RADIANCE = FOLDER / "oracle_radiance_ptfe532_klems.xml"

TEXT = """# Sintered PTFE of NIST

Made by `python -m tests.validation nist-ptfe` from the readings published with [Germer2017]: four wavelengths, incidence
0 to 75° in steps of 15°, about 304 directions of the hemisphere each.

## Directional-hemispherical reflectance

u is the standard uncertainty gonio states for the integral, k = 1: noise of the readings, quadrature, extrapolation. What
NIST states for all readings in common (its reference) is not in it. The extrapolated share is the part of DHR from directions that no reading surrounds.

{dhr}
## Incidences left out

Each interior incidence is predicted from the others, which leaves a gap of 30°. Root mean square of the DSF's
difference from the readings held out over that of the readings, by solid angle, in percent. The differences contain
the noise of the readings held out.

{loo}
## Klems matrices

Largest directional albedo of an incident patch (full basis) of the model's Klems matrices. RADIANCE's own route
(pabopto2bsdf, bsdf2klems) from the same files of 532 nm gives {peer}: more light than arrives.

{klems}"""


def measured(wavelength: int) -> Any:
    """The processed readings of one wavelength."""
    files = sorted(FOLDER.glob(f"ptfe_{wavelength}nm_i*.txt"))
    if len(files) != 6:
        raise Skipped(f"{FOLDER.name} has {len(files)} files of {wavelength} nm, needed 6")
    return gonio.process(files)


def dhr_rows(wavelength: int, measurement: Any) -> list[list[str]]:
    """Wavelength, incidence, DHR, u, extrapolated share of every slice."""
    rows = []
    for s in sorted(measurement.slices, key=lambda s: s.theta_i):
        (integral,) = [i for i in s.integrals if i.side == "front"]
        share = 100 * integral.extrapolated / integral.value
        rows.append(
            [
                f"{wavelength} nm",
                f"{s.theta_i:.0f}°",
                f"{integral.value:.4f}",
                f"{integral.u:.4f}",
                f"{share:.2f} %",
            ]
        )
    return rows


def radiance_albedo(path: Path) -> str:
    """Largest albedo of an incident patch in RADIANCE's file."""
    if not path.exists():
        raise Skipped(f"{path.name} is not there")
    model = _native.read_radiance_xml(path)
    return f"{max(model.albedo(side=s, component=c).max() for s, c in model.components):.3f}"


def make() -> str:
    """The page."""
    dhr, loo, klems = [], [], []
    for wavelength in WAVELENGTHS:
        measurement = measured(wavelength)
        dhr += dhr_rows(wavelength, measurement)
        model = gonio.build(measurement)
        summary = model.summary[0]
        errors = {round(e["theta_i"]): 100 * e["rel_rms"] for e in model.loo}
        loo.append(
            [f"{wavelength} nm", *(f"{errors[t]:.2f}" for t in (15, 30, 45, 60)), summary["candidate"]]
        )
        reduced = _native.to_klems(model, components=[("front", "reflection")])
        klems.append([f"{wavelength} nm", f"{reduced.report['max_albedo']:.4f}"])
    return TEXT.format(
        dhr=table(["wavelength", "incidence", "DHR", "u", "extrapolated"], dhr),
        loo=table(["wavelength", "15°", "30°", "45°", "60°", "candidate chosen"], loo),
        klems=table(["wavelength", "largest albedo"], klems),
        peer=radiance_albedo(KLEMS_OF_RADIANCE),
    )
