"""Data-driven models of real materials where nothing was measured, against RADIANCE's tensor tree.

Four isotropic materials of the RGL database [DupuyJakob2018], green channel, as the reader gives them, are
the truth. Eight incidences, 10 to 80 degrees, are read as in `bench.models` (some 46,700 readings each, noise
of 1 % and 2e-4/sr). Errors are relative L1 of the DSF over the hemisphere up to 88 degrees: at 15, 35, 45, 55
and 75 degrees (held out), at the eight incidences (measured), at 85 degrees (beyond the data). RADIANCE makes
its model of the same files (pabopto2bsdf, bsdf2ttree -g 6). The ratio is of the geometric means of the mean
held-out errors of the four.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from gonio import _native

from bench._materials import Array, direction, readings, unit
from bench._timing import seconds
from bench.models import Eval, measurement, of_model, peer, record

IDS = ("heldout-rgl-vs-radiance-ttree",)
SHARED = Path(os.environ.get("GONIO_SHARED_DATA", Path(__file__).parents[2] / "shared" / "data"))
MATERIALS = ("aurora_white", "cm_military_green", "chm_orange", "irid_flake_paint1")
MEASURED = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0)
KINDS: Mapping[str, tuple[float, ...]] = {
    "held_out": (15.0, 35.0, 45.0, 55.0, 75.0),
    "measured": MEASURED,
    "beyond": (85.0,),
}
RINGS, AZIMUTHS, FIRST = 500, 360, 0.02
"""Rings of the quadrature about the mirror direction, readings on each, radius of the first (degrees)."""


def truth(name: str) -> Any:
    """The green channel of a material as the formula that `bench._materials` takes."""
    model = _native.read_rgl(SHARED / "rgl-rgb" / f"{name}_rgb.bsdf")
    green = list(model.channels).index("green")

    def values(v: Array, w: Array) -> Array:
        f = model.eval_directions(wi=np.ascontiguousarray(v[0]), ws=w)[green]
        out: Array = np.maximum(f, 0.0)
        return out

    return values


def quadrature(theta_i: float) -> tuple[Array, Array]:
    """Directions up to 88 degrees and solid angles times cosines.

    They stand on rings about the mirror direction whose radii grow by a constant factor, so that lobes of
    any width are resolved.
    """
    edges = np.geomspace(np.radians(FIRST), np.pi, RINGS + 1)
    edges[0] = 0.0
    cosines = np.cos(edges)
    middle = np.arccos(0.5 * (cosines[1:] + cosines[:-1]))
    azimuth = 2 * np.pi * (np.arange(AZIMUTHS) + 0.5) / AZIMUTHS
    spot = direction(theta_i, 0.0)
    along = unit(np.cross([0.0, 1.0, 0.0], spot))
    across = np.cross(spot, along)
    t, p = (a.ravel()[:, None] for a in np.meshgrid(middle, azimuth, indexing="ij"))
    w = np.cos(t) * spot + np.sin(t) * (np.cos(p) * along + np.sin(p) * across)
    weight = np.repeat(-np.diff(cosines) * 2 * np.pi / AZIMUTHS, AZIMUTHS) * w[:, 2]
    up = w[:, 2] > np.cos(np.radians(88))
    return w[up], weight[up]


def measured(material: Any) -> _native.MeasurementData:
    """The readings of a material at the eight incidences."""
    return measurement({t: readings(material, t, 20261122) for t in MEASURED})


def rel_l1(material: Any, found: Eval, theta_i: float) -> float:
    """Relative L1 difference of `found` from the material at one incidence."""
    w, weight = quadrature(theta_i)
    known = material(np.broadcast_to(direction(theta_i, 180.0), w.shape), w)
    return float((weight * np.abs(found(theta_i, w) - known)).sum() / (weight * known).sum())


def errors(material: Any, found: Eval) -> dict[str, list[float]]:
    """Errors at every incidence of every kind."""
    return {kind: [rel_l1(material, found, t) for t in thetas] for kind, thetas in KINDS.items()}


def run() -> list[dict[str, Any]]:
    missing = [n for n in MATERIALS if not (SHARED / "rgl-rgb" / f"{n}_rgb.bsdf").exists()]
    if missing:
        print(f"{IDS[0]}: skipped, {', '.join(missing)} not in {SHARED / 'rgl-rgb'}")
        return []
    ours: dict[str, Any] = {}
    theirs: dict[str, Any] = {}
    for name in MATERIALS:
        material = truth(name)
        data = {t: readings(material, t, 20261122) for t in MEASURED}
        scan = measurement(data)
        spent, model = seconds(lambda m=scan: _native.build(m, symmetry="isotropic"))
        ours[name] = errors(material, of_model(model)) | {"cpu": spent}
        ours[name]["stated"] = [
            model.stated_error(theta_i=t, phi_i=180.0, component="reflection")["total"]
            for t in KINDS["held_out"]
        ]
        ours[name] |= {key: model.summary[0][key] for key in ("candidate", "base")}
        ours[name]["warnings"] = model.warnings
        with tempfile.TemporaryDirectory() as folder:
            spent, tree = peer(data, Path(folder))
        theirs[name] = errors(material, of_model(tree)) | {"cpu": spent}
    return [record(IDS[0], ours, theirs, MATERIALS)]
