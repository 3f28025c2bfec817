"""Data-driven models of real samples at incidences they never saw."""

from __future__ import annotations

import json
from typing import Any

import gonio
from gonio import _native

from bench import rgl

from ..left_out import COATINGS, SPHERE, blank, coating, without
from ..places import ROOT
from . import Skipped, table
from .nist_ptfe import WAVELENGTHS, measured

TEXT = """# Data-driven models of real samples

Made by `python -m tests.validation data-driven`. Errors are relative L1 of the DSF, ∫|f' − f| cos dω / ∫f cos dω, in percent, at
incidences that were not among those the model was built from; the stated error is what the model says of itself there.

## RGL materials

Four isotropic materials [DupuyJakob2018], green channel, read at 10 to 80° in steps of 10° (some 46,700 directions each: rings 3° ×
0.2°, a 15° patch of 0.5° × 0.1°; noise 1 % + 2·10⁻⁴ sr⁻¹). In brackets the stated error. RADIANCE: pabopto2bsdf and bsdf2ttree
-g 6 from the same files, by `python -m bench heldout-rgl-vs-radiance-ttree`, which found {ratio} (ratio of geometric means).

{rgl}
{chosen}
Between measured incidences RGL's own data are interpolated (its incidences are about 0, 30, 43, 53, 62, 71 and 80°): past 70° the
reference is as uncertain as the models. The model warns that errors grow there. Up to 55° the true error is {least} to
{most} times the stated one.

## Black coatings

J&C RT-300S, 650 nm, incidence 10, 30, 50 and 70°, 627 directions each, blank subtracted, as read: the sample's tilt of 2 to 4° is left
in. One incidence is dropped and predicted from the other three, of which one only can be left out to choose by. The same
sample turned repeats within 4 to 6 %.

{coatings}
## Sintered PTFE

Readings published with [Germer2017], 304 directions at 0 to 75° in steps of 15°; each interior incidence predicted from the others,
root mean square of the DSF's difference from the readings over that of the readings, by solid angle, in percent. It contains the noise of the
readings left out. The goal, 1.6 % to the independent set at random directions, cannot be measured here: that set is not
among the data here.

{ptfe}
## An imaging sphere's file

Radiant Imaging Sphere, 13 incidences from 15 to 75°, some 200 to 350 directions each; each interior incidence predicted from the others, by
{sphere_rule}.

{sphere}"""


def percent(values: list[float]) -> list[str]:
    return [f"{100 * v:.1f}" for v in values]


def rgl_rows() -> tuple[list[list[str]], list[str], list[float], str]:
    """A row a material, sentences on the choice, ratios of true to stated error up to 55 degrees, RADIANCE's ratio."""
    records = json.loads((ROOT / "bench" / "results.json").read_text())
    (record,) = [r for r in records if r["id"] == rgl.IDS[0]] or [None]
    if record is None:
        raise Skipped(f"{rgl.IDS[0]} is not in bench/results.json")
    rows, sentences, ratios = [], [], []
    for name in rgl.MATERIALS:
        if not (rgl.SHARED / "rgl-rgb" / f"{name}_rgb.bsdf").exists():
            raise Skipped(f"{name} is not in {rgl.SHARED / 'rgl-rgb'}")
        material = rgl.truth(name)
        model = _native.build(rgl.measured(material), symmetry="isotropic")
        thetas = rgl.KINDS["held_out"]
        found = [rgl.rel_l1(material, rgl.of_model(model), t) for t in thetas]
        stated = [total(model, t) for t in thetas]
        cells = [f"{100 * f:.1f} ({100 * s:.1f})" for f, s in zip(found, stated, strict=True)]
        theirs = record["peer_details"][name]["held_out"]
        mean = sum(found) / len(found)
        rows.append([name, *cells, f"**{100 * mean:.1f}**", f"{100 * sum(theirs) / len(theirs):.0f}"])
        ratios += [f / s for f, s in zip(found[:-1], stated[:-1], strict=True)]
        summary = model.summary[0]
        sentences.append(f"- {name}: {summary['candidate']}, {summary['base'] or 'no base'}")
    return rows, sentences, ratios, f"{record['ratio']:.1f} ×"


def total(model: Any, theta_i: float) -> float:
    """The error a model states."""
    stated = model.stated_error(theta_i=theta_i, phi_i=180.0)
    return float(stated["total"])


def coating_rows() -> list[list[str]]:
    """A row a sample and incidence dropped."""
    rows = []
    for name in COATINGS:
        for path in (coating(name), blank()):
            if not path.exists():
                raise Skipped(f"{path.name} is not on this machine")
        measurement = gonio.process(coating(name), dark=blank())
        for theta_i in (30.0, 50.0):
            found = without(measurement, theta_i)
            cells = percent([found.rel_l1, found.stated])
            rows.append([name, f"{theta_i:.0f}°", *cells, found.candidate, found.base or "–"])
    return rows


def ptfe_rows() -> list[list[str]]:
    """A row a wavelength."""
    rows = []
    for wavelength in WAVELENGTHS:
        model = gonio.build(measured(wavelength))
        errors = {round(e["theta_i"]): 100 * e["rel_rms"] for e in model.loo}
        summary = model.summary[0]
        chosen = [summary["candidate"], summary["base"] or "–"]
        rows.append([f"{wavelength} nm", *(f"{errors[t]:.2f}" for t in (15, 30, 45, 60)), *chosen])
    return rows


def sphere_rows() -> tuple[list[list[str]], str]:
    """Errors of the sphere's file, and what predicted them."""
    if not SPHERE.exists():
        raise Skipped(f"{SPHERE.name} is not on this machine")
    model = gonio.build(gonio.process(SPHERE, channel="photopic"))
    errors = sorted(model.loo, key=lambda e: e["theta_i"])
    rows = [
        ["relative L1, %", *percent([e["rel_l1"] for e in errors])],
        ["rms, %", *percent([e["rel_rms"] for e in errors])],
    ]
    summary = model.summary[0]
    return [
        [f"{e['theta_i']:.0f}°" for e in errors],
        *rows,
    ], f"{summary['candidate']} ({summary['base'] or 'no base'})"


def make() -> str:
    """The page."""
    rows, sentences, ratios, ratio = rgl_rows()
    held = [f"{t:.0f}°" for t in rgl.KINDS["held_out"]]
    sphere, rule = sphere_rows()
    return TEXT.format(
        rgl=table(["material", *held, "mean", "RADIANCE, mean"], rows),
        chosen="\n".join(sentences) + "\n",
        ratio=ratio,
        least=f"{min(ratios):.1f}",
        most=f"{max(ratios):.1f}",
        coatings=table(["sample", "dropped", "error", "stated", "candidate", "base"], coating_rows()),
        ptfe=table(["wavelength", "15°", "30°", "45°", "60°", "candidate", "base"], ptfe_rows()),
        sphere_rule=rule,
        sphere=table(["incidence", *sphere[0]], sphere[1:]),
    )
