"""Data-driven models of known isotropic materials where nothing was measured, against RADIANCE's tensor tree.

Eight incidences, 10 to 80 degrees, some 40,000 readings each with noise of 1 % and 2e-4/sr. Errors are
relative L1 of the DSF, the integral of |f' - f| cos over that of f cos, over the hemisphere up to 88
degrees: at 15, 25 to 75 degrees (held out), at 20 to 70 degrees (measured), at 85 degrees (beyond the
data). RADIANCE makes its model of the same files (pabopto2bsdf, bsdf2ttree -g 6). The ratio is of the
geometric means over the six materials with lobes about the mirror direction; those of all seven are in
the record.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from gonio import _native

from bench._materials import ISOTROPIC, Array, Brdf, direction, readings
from bench._slices import photopic
from bench._timing import seconds
from bench.export import peer_seconds

IDS = ("heldout-iso-vs-radiance-ttree",)
MEASURED = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0)
KINDS: Mapping[str, tuple[float, ...]] = {
    "held_out": (15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0),
    "measured": (20.0, 30.0, 40.0, 50.0, 60.0, 70.0),
    "beyond": (85.0,),
}
GRID = 400
"""Cells along each side of the square of equal projected solid angles that errors are summed over."""

Eval = Callable[[float, Array], Array]


def outgoing() -> Array:
    """Centres of cells of equal projected solid angle, up to 88 degrees."""
    x = 2 * (np.arange(GRID) + 0.5) / GRID - 1
    a, b = np.meshgrid(x, x, indexing="ij")
    # Shirley and Chiu's concentric map of the square onto the disk.
    wide = np.abs(a) > np.abs(b)
    radius = np.where(wide, a, b)
    other = np.where(wide, b, a)
    ratio = np.divide(other, radius, out=np.zeros_like(radius), where=radius != 0)
    angle = np.where(wide, np.pi / 4 * ratio, np.pi / 2 - np.pi / 4 * ratio)
    u, v = (radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel()
    z = np.sqrt(np.maximum(1 - u * u - v * v, 0))
    kept: Array = np.stack([u, v, z], axis=-1)[z > np.cos(np.radians(88))]
    return kept


def rel_l1(material: Brdf, found: Eval, theta_i: float, w: Array) -> float:
    """Relative L1 difference of `found` from the material at one incidence."""
    truth = material(np.broadcast_to(direction(theta_i, 180.0), w.shape), w)
    return float(np.abs(found(theta_i, w) - truth).sum() / truth.sum())


def measurement(data: Mapping[float, tuple[Array, Array, Array]]) -> _native.MeasurementData:
    """The readings as a measurement."""
    slices = []
    for theta_i, (w, dsf, sigma) in data.items():
        theta, phi = np.degrees(np.arccos(w[:, 2])), np.degrees(np.arctan2(w[:, 1], w[:, 0])) % 360
        omega = _native.hemisphere_weights(theta, phi, side="front")[0]
        slices.append(photopic((theta_i, 180.0), (theta, phi), dsf, sigma, omega))
    return _native.MeasurementData(slices)


def of_model(model: _native.Bsdf) -> Eval:
    """The values of a model of ours."""

    def values(theta_i: float, w: Array) -> Array:
        wi = direction(theta_i, 180.0)
        f: Array = model.eval_directions(wi=wi, ws=w).reshape(w.shape[0], -1)[:, 0]
        return f

    return values


def peer(data: Mapping[float, tuple[Array, Array, Array]], folder: Path) -> tuple[float, _native.Bsdf]:
    """CPU seconds and RADIANCE's tensor tree of the same readings."""
    names = []
    for theta_i, (w, dsf, _) in data.items():
        theta, phi = np.degrees(np.arccos(w[:, 2])), np.degrees(np.arctan2(w[:, 1], w[:, 0])) % 360
        name = f"in_{theta_i:g}.txt"
        with (folder / name).open("w") as file:
            file.write(
                f"#format: theta phi DSF\n#incident_angle {theta_i:g} 180\n#upphi 90\n#colorimetry: CIE-Y\n"
            )
            np.savetxt(file, np.stack([theta, phi, dsf], axis=1), fmt="%.4f %.4f %.6g")
        names.append(name)
    spent = peer_seconds(folder, "model.sir", "pabopto2bsdf", *names)
    spent += peer_seconds(folder, "model.xml", "bsdf2ttree", "-g", "6", "model.sir")
    return spent, _native.read_radiance_xml(folder / "model.xml")


def errors(material: Brdf, found: Eval, w: Array) -> dict[str, list[float]]:
    """Errors at every incidence of every kind."""
    return {kind: [rel_l1(material, found, t, w) for t in thetas] for kind, thetas in KINDS.items()}


def record(name: str, ours: dict[str, Any], theirs: dict[str, Any], over: Iterable[str]) -> dict[str, Any]:
    """The record of held-out errors: geometric means over some of the materials."""
    materials = list(over)

    def mean(of: dict[str, Any]) -> float:
        return math.exp(np.mean([math.log(np.mean(of[m]["held_out"])) for m in materials]))

    return {
        "id": name,
        "ours": mean(ours),
        "peer": mean(theirs),
        "peer_name": "RADIANCE pabopto2bsdf, bsdf2ttree -g 6",
        "ratio": mean(theirs) / mean(ours),
        "unit": "relative L1",
        "command": f"python -m bench {name}",
        "details": ours,
        "peer_details": theirs,
    }


def run() -> list[dict[str, Any]]:
    w = outgoing()
    ours: dict[str, Any] = {}
    theirs: dict[str, Any] = {}
    for name, material in ISOTROPIC.items():
        data = {t: readings(material, t, 20261122) for t in MEASURED}
        measured = measurement(data)
        spent, model = seconds(lambda m=measured: _native.build(m, symmetry="isotropic"))
        ours[name] = errors(material, of_model(model), w) | {"cpu": spent, "stated": model.loo_error}
        ours[name]["chosen"] = [s["candidate"] for s in model.summary]
        with tempfile.TemporaryDirectory() as folder:
            spent, tree = peer(data, Path(folder))
        theirs[name] = errors(material, of_model(tree), w) | {"cpu": spent}
    lobes = [name for name in ISOTROPIC if name != "redirecting"]
    return [record(IDS[0], ours, theirs, lobes)]
