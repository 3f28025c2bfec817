"""Data-driven models of known anisotropic and transmitting materials where nothing was measured.

26 incidences (41 for the sample that repeats after half a turn only) of some 19,000 readings with noise of
1 % and 2e-4/sr. Errors at 16 incidences between them, theta_i 22.5 to 67.5 degrees: relative L1 and root
mean square of the DSF over solid angle, the share of light, the highest value and how far it lies from the
true one, and the light within 1.5 degrees of the mirror (through) direction.

RADIANCE makes its model of the same files of the first material (pabopto2bsdf). Its interpolant is queried
at incidences between the measured ones by bsdf2ttree without culling: that program asks for it at the
centres of the tree's cells of incidence, and averages over its cells of exit. Both models and the truth are
averaged over these cells, which is kind to errors that are finer than a cell.

`python -m bench.aniso [names...]` prints the figures of single materials.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from gonio import _native

from bench._anisotropic import LEAST_COSINE, SAMPLES, Readings, Sample, Values, cone, readings
from bench._materials import Array, direction, mirror
from bench._slices import photopic
from bench._timing import seconds
from bench.export import peer_seconds

IDS = ("heldout-aniso-vs-radiance-sir", "build-aniso-vs-pabopto2bsdf")
SEED = 20261122
LEVEL = 4
"""RADIANCE's tree has 2 to this many cells along each side of both disks."""
INSIDE = 16
"""Points along each side of a cell of exit that truth and model are averaged over."""


def hemisphere(count: int) -> Array:
    """Directions evenly spread over the projected solid angle up to 88.5 degrees."""
    k = np.arange(count) + 0.5
    r = np.sqrt(k / count * (1 - LEAST_COSINE**2))
    phi = np.pi * (1 + np.sqrt(5)) * k
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r * r)], axis=-1)


def quadrature(sample: Sample, v: Array) -> tuple[Array, Array]:
    """Directions and solid angles: even over the hemisphere, denser about the two highest places."""
    w = np.concatenate([hemisphere(12_000), cone(mirror(v), 3, 1500)])
    w = w[w[:, 2] > LEAST_COSINE]
    dsf = sample.brdf(np.broadcast_to(v, w.shape), w) * w[:, 2]
    centres = [w[dsf.argmax()]]
    far = np.where(w @ centres[0] < np.cos(np.radians(14)), dsf, -1.0)
    if far.max() > 0.1 * dsf.max():
        centres.append(w[far.argmax()])
    regions = [(c, r, n) for r, n in ((25.0, 5000), (6.0, 2000), (1.5, 800)) for c in centres]
    w = hemisphere(12_000)
    parts = [(w, np.pi * (1 - LEAST_COSINE**2) / len(w) / w[:, 2])]
    for centre, radius, count in regions:
        solid_angle = 2 * np.pi * (1 - np.cos(np.radians(radius))) / count
        parts.append((cone(centre, radius, count), np.full(count, solid_angle)))
    kept = []
    for k, (w, omega) in enumerate(parts):
        own = w[:, 2] > LEAST_COSINE
        for centre, radius, _ in regions[k:]:
            own &= w @ centre < np.cos(np.radians(radius))
        kept.append((w[own], omega[own]))
    return np.concatenate([p[0] for p in kept]), np.concatenate([p[1] for p in kept])


def errors(sample: Sample, found: Values, v: Array) -> dict[str, float]:
    """How `found` differs from the sample at incidence `v`."""
    w, omega = quadrature(sample, v)
    truth = sample.brdf(np.broadcast_to(v, w.shape), w) * w[:, 2]
    dsf = found(v, w) * w[:, 2]
    a, b = int(dsf.argmax()), int(truth.argmax())
    flux = float((omega * truth).sum())
    near = w @ mirror(v) > np.cos(np.radians(1.5))
    return {
        "rel_l1": float((omega * abs(dsf - truth)).sum()) / flux,
        "rms": float(np.sqrt((omega * (dsf - truth) ** 2).sum() / (omega * truth**2).sum())),
        "share": float((omega * dsf).sum()) / flux - 1,
        "peak": float(dsf[a] / truth[b] - 1),
        "shift": float(np.degrees(np.arccos(np.clip(w[a] @ w[b], -1, 1)))),
        "through": float((omega * (dsf - truth))[near].sum()),
    }


def of_model(model: _native.Bsdf, *, transmits: bool) -> Values:
    """The values of a model of ours."""
    sign = np.array([1.0, 1.0, -1.0 if transmits else 1.0])

    def values(v: Array, w: Array) -> Array:
        f: Array = model.eval_directions(wi=v, ws=w * sign).reshape(w.shape[0], -1)[:, 0]
        return f

    return values


def angles(sample: Sample, w: Array) -> tuple[Array, Array]:
    """Polar angle and azimuth of the receiver, degrees."""
    theta, phi = np.degrees(np.arccos(w[:, 2])), np.degrees(np.arctan2(w[:, 1], w[:, 0])) % 360
    return (180 - theta if sample.transmits else theta), phi


def measurement(sample: Sample, data: Mapping[tuple[float, float], Readings]) -> _native.MeasurementData:
    """The readings as a measurement."""
    side = "back" if sample.transmits else "front"
    slices = []
    for incidence, (w, dsf, sigma) in data.items():
        theta, phi = angles(sample, w)
        omega = _native.hemisphere_weights(theta, phi, side=side)[0]
        slices.append(photopic(incidence, (theta, phi), dsf, sigma, omega))
    return _native.MeasurementData(slices)


def figures(name: str) -> tuple[_native.DataDriven, dict[str, Any]]:
    """The model of a material and its errors."""
    sample = SAMPLES[name]
    measured = measurement(sample, readings(sample, sample.incidences(), SEED))
    spent, model = seconds(lambda: _native.build(measured, symmetry="anisotropic"))
    found = of_model(model, transmits=sample.transmits)
    component = "transmission" if sample.transmits else "reflection"
    each = []
    for theta_i, phi_i in sample.held_out():
        error = errors(sample, found, direction(theta_i, phi_i))
        stated = model.stated_error(theta_i=theta_i, phi_i=phi_i, component=component)
        each.append(error | {"stated": stated["total"], "theta_i": theta_i, "phi_i": phi_i})
    at_nodes = [errors(sample, found, direction(t, p)) for t, p in sample.incidences()[1::4]]
    ratio = np.array([e["stated"] / e["rel_l1"] for e in each])
    summary = model.summary[0]
    return model, {
        "cpu": spent,
        "candidate": summary["candidate"],
        "base": summary["base"],
        "rel_l1": mean_and_worst(each, "rel_l1"),
        "rms": mean_and_worst(each, "rms"),
        "share": mean_and_worst(each, "share"),
        "peak": mean_and_worst(each, "peak"),
        "shift": mean_and_worst(each, "shift"),
        "through": mean_and_worst(each, "through"),
        "measured_rel_l1": mean_and_worst(at_nodes, "rel_l1"),
        "measured_rms": mean_and_worst(at_nodes, "rms"),
        "stated_within_2": float(np.mean((ratio > 0.5) & (ratio < 2))),
        "stated_over_true": [float(ratio.min()), float(np.median(ratio)), float(ratio.max())],
        "spacing": max(s["spacing"] for s in summary["slices"]),
        "each": each,
        "warnings": model.warnings,
    }


def mean_and_worst(each: Sequence[Mapping[str, float]], key: str) -> tuple[float, float]:
    """Mean and largest absolute value."""
    values = [abs(e[key]) for e in each]
    return float(np.mean(values)), max(values)


def cells() -> tuple[Array, Array]:
    """Centres of the tree's cells, and points in each of them (cells, points), directions with z > 0."""
    n = 2**LEVEL
    fine = (np.arange(n * INSIDE) + 0.5) / (n * INSIDE)
    centres = (np.arange(n) + 0.5) / n
    a, b = np.meshgrid(centres, centres, indexing="ij")
    within = fine.reshape(n, INSIDE)
    x = np.broadcast_to(within[:, None, :, None], (n, n, INSIDE, INSIDE)).reshape(n * n, -1)
    y = np.broadcast_to(within[None, :, None, :], (n, n, INSIDE, INSIDE)).reshape(n * n, -1)
    return disk(a.ravel(), b.ravel()), disk(x, y)


def disk(x: Array, y: Array) -> Array:
    """Shirley and Chiu's map of the unit square to the disk, as directions."""
    a, b = 2 * x - 1, 2 * y - 1
    wide = np.abs(a) > np.abs(b)
    radius = np.where(wide, a, b)
    other = np.where(wide, b, a)
    ratio = np.divide(other, radius, out=np.zeros_like(radius), where=radius != 0)
    angle = np.where(wide, np.pi / 4 * ratio, np.pi / 2 - np.pi / 4 * ratio)
    u, v = radius * np.cos(angle), radius * np.sin(angle)
    return np.stack([u, v, np.sqrt(np.maximum(1 - u * u - v * v, 0))], axis=-1)


def write(sample: Sample, data: Mapping[tuple[float, float], Readings], folder: Path) -> list[str]:
    """The readings as files of RADIANCE's; their names."""
    names = []
    for (theta_i, phi_i), (w, dsf, _) in data.items():
        theta, phi = angles(sample, w)
        name = f"in_{theta_i:g}_{phi_i:g}.txt"
        with (folder / name).open("w") as file:
            file.write(
                "#format: theta phi DSF\n"
                f"#incident_angle {theta_i:g} {phi_i:g}\n#upphi 90\n#colorimetry: CIE-Y\n"
            )
            np.savetxt(file, np.stack([theta, phi, dsf], axis=1), fmt="%.4f %.4f %.6g")
        names.append(name)
    return names


def cell_rms(sample: Sample, found: Values, v: Array, points: Array) -> float:
    """Relative root mean square of the DSF, averaged over the cells of exit, at incidence `v`."""
    z = points[..., 2].mean(axis=1)
    kept = points[..., 2].min(axis=1) > LEAST_COSINE
    flat = points[kept].reshape(-1, 3)
    shape = (int(kept.sum()), points.shape[1])
    truth = sample.brdf(np.broadcast_to(v, flat.shape), flat).reshape(shape).mean(axis=1)
    model = found(v, flat).reshape(shape).mean(axis=1)
    # Cells of equal projected solid angle: the square of a DSF over solid angle keeps one cosine.
    return float(np.sqrt((z[kept] * (model - truth) ** 2).sum() / (z[kept] * truth**2).sum()))


def against_radiance() -> dict[str, Any]:
    """Both models of the first material at cells of incidence between the measured ones, and CPU seconds."""
    sample = SAMPLES["ward"]
    data = readings(sample, sample.incidences(), SEED)
    spent, model = seconds(lambda: _native.build(measurement(sample, data), symmetry="anisotropic"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = write(sample, data, folder)
        theirs = peer_seconds(folder, "model.sir", "pabopto2bsdf", *files)
        options = ["-g", str(LEVEL), "-t", "0", "model.sir"]
        tree_cpu = peer_seconds(folder, "model.xml", "bsdf2ttree", *options)
        tree = _native.read_radiance_xml(folder / "model.xml")
    centres, points = cells()
    theta = np.degrees(np.arccos(centres[:, 2]))
    phi = np.degrees(np.arctan2(centres[:, 1], centres[:, 0])) % 360
    chosen = np.flatnonzero((theta > 20) & (theta < 70) & (phi < 90))
    held = chosen[:: max(1, len(chosen) // 16)][:16]
    # One point a cell: the tree is constant in it.
    rms = {
        who: [cell_rms(sample, of_model(m, transmits=False), centres[k], points) for k in held]
        for who, m in (("ours", model), ("theirs", tree))
    }
    return {
        "ours": float(np.mean(rms["ours"])),
        "theirs": float(np.mean(rms["theirs"])),
        "worst": [max(rms["ours"]), max(rms["theirs"])],
        "incidences": [[float(theta[k]), float(phi[k])] for k in held],
        "cpu": [spent, theirs, tree_cpu],
    }


def without(found: Mapping[str, Any], key: str) -> dict[str, Any]:
    """The figures but one."""
    return {k: v for k, v in found.items() if k != key}


def show(name: str, found: Mapping[str, Any]) -> None:
    """A few lines on a material."""
    print(f"{name}: {found['candidate']}, {found['base']}; {found['cpu']:.1f} CPU s")
    for key in ("rel_l1", "rms", "share", "peak", "shift", "through", "measured_rel_l1", "measured_rms"):
        print(f"  {key:16} {found[key][0]:.4f} ({found[key][1]:.4f})")
    low, median, high = found["stated_over_true"]
    close = found["stated_within_2"]
    print(f"  stated / true    {median:.2f} ({low:.2f} to {high:.2f}), {close:.0%} within 2 x")
    print(f"  spacing          {found['spacing']:.2f} narrow half widths")
    for warning in found["warnings"]:
        print(f"  ! {warning}")


def run() -> list[dict[str, Any]]:
    details = {name: figures(name)[1] for name in SAMPLES}
    for name, found in details.items():
        show(name, found)
    versus = against_radiance()
    ours, theirs, tree = versus["cpu"]
    return [
        {
            "id": IDS[0],
            "ours": versus["ours"],
            "peer": versus["theirs"],
            "peer_name": "RADIANCE pabopto2bsdf",
            "ratio": versus["theirs"] / versus["ours"],
            "unit": "rms",
            "command": f"python -m bench {IDS[0]}",
            "versus": versus,
            "details": {name: without(found, "each") for name, found in details.items()},
        },
        {
            "id": IDS[1],
            "ours": ours,
            "peer": theirs,
            "peer_name": "RADIANCE pabopto2bsdf",
            "ratio": theirs / ours,
            "unit": "CPU s",
            "command": f"python -m bench {IDS[1]}",
            "peer_tree": tree,
        },
    ]


if __name__ == "__main__":
    for wanted in sys.argv[1:] or list(SAMPLES):
        built, shown = figures(wanted)
        show(wanted, shown)
        for candidate, score in sorted(built.summary[0]["scores"].items(), key=lambda s: s[1]):
            print(f"    {candidate:32} {score:.4f}")
        sys.stdout.flush()
