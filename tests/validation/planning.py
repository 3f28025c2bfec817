"""Planned and uniform paths over known materials: how many readings reach which errors and claims."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from gonio import _native
from gonio._native import Bsdf
from gonio.instrument_spectra import outputs
from gonio.instruments import Instrument, read_instrument

from .loop_closure import directions, seen

CASES: dict[str, list[dict]] = {
    "Ward-GMD, alpha .02": [
        {"model": "lambert", "rho": 0.2},
        {"model": "ward-gmd", "rho": 0.6, "alpha": 0.02},
    ],
    "Ward-GMD, alpha .05": [
        {"model": "lambert", "rho": 0.2},
        {"model": "ward-gmd", "rho": 0.6, "alpha": 0.05},
    ],
    "Ward-GMD, alpha .1": [
        {"model": "lambert", "rho": 0.2},
        {"model": "ward-gmd", "rho": 0.6, "alpha": 0.1},
    ],
    "GGX, alpha .05": [
        {"model": "lambert", "rho": 0.2},
        {"model": "ggx", "f0": 0.6, "alpha": 0.05},
    ],
    "brushed, alpha .04, .3": [
        {"model": "lambert", "rho": 0.1},
        {"model": "ward-gmd-anisotropic", "rho": 0.6, "alpha_x": 0.04, "alpha_y": 0.3, "phi_x": 20.0},
    ],
}
"""Materials, diffuse parts first."""

THETA_I = (10.0, 45.0, 75.0)
PITCHES = tuple(12.0 * 2.0 ** (-k / 3) for k in range(13))
"""Pitches of uniform paths, degrees."""


def instrument() -> Instrument:
    """A full-sphere instrument without what its calibration uncertainty stands for."""
    it = read_instrument("pgII-like").with_settings({"lamp_drift": 0.0})
    ranges = [(scale, noise, 0.0) for scale, noise, _ in it.parts["ranges"]]
    return Instrument(
        name=it.name,
        settings=it.settings,
        parts={**it.parts, "ranges": ranges},
        lamp=it.lamp,
        channels=it.channels,
        u_calibration=0.0,
    )


def material(name: str) -> Bsdf:
    return _native.analytic(CASES[name])


def uniform(pitch: float, theta_max: float, rng: np.random.Generator) -> list[tuple[float, float]]:
    """Rings `pitch` degrees apart from a random start, read at steps of `pitch` from random starts."""
    rows: list[tuple[float, float]] = []
    for theta in np.arange(pitch * rng.uniform(0.02, 1.0), theta_max, pitch):
        n = max(3, round(360.0 * np.sin(np.radians(theta)) / pitch))
        phi = (rng.uniform(0.0, 360.0) + 360.0 * np.arange(n) / n) % 360.0
        rows += [(float(theta), float(p)) for p in phi]
    return rows


@dataclass(frozen=True)
class Reached:
    """Readings, root mean square errors and claims, relative."""

    readings: float
    dhr_error: float
    dhr_claim: float
    peak_error: float
    peak_claim: float

    def within(self, other: Reached, *, claims: bool) -> bool:
        """Whether both quantities are as good as those of `other`."""
        if claims:
            return self.dhr_claim <= other.dhr_claim and self.peak_claim <= other.peak_claim
        return self.dhr_error <= other.dhr_error and self.peak_error <= other.peak_error


def true_peak(model: Bsdf, settings: dict[str, float], theta_i: float, phi_i: float) -> float:
    """Highest DSF as the instrument sees it, by the average of loop_closure.py."""
    mirror = directions(np.array(theta_i), np.array(phi_i + 180.0))
    a = np.array([-np.sin(np.radians(phi_i)), np.cos(np.radians(phi_i)), 0.0])
    b = np.cross(mirror, a)
    centre, step = np.zeros(2), 1.0
    height = 0.0
    while step > 0.02:
        x, y = np.meshgrid(centre[0] + step * np.arange(-2, 3), centre[1] + step * np.arange(-2, 3))
        v = mirror + np.radians(x.ravel())[:, None] * a + np.radians(y.ravel())[:, None] * b
        v /= np.linalg.norm(v, axis=1, keepdims=True)
        place = SimpleNamespace(
            theta_i=theta_i,
            phi_i=phi_i,
            theta_s=np.degrees(np.arccos(np.clip(v[:, 2], -1, 1))),
            phi_s=np.degrees(np.arctan2(v[:, 1], v[:, 0])),
        )
        values = np.where(v[:, 2] > 0.02, seen(model, settings, place, np.arange(len(v)), nodes=1024), 0.0)
        best = int(np.argmax(values))
        centre = np.array([x.ravel()[best], y.ravel()[best]])
        height = float(values[best])
        # On the rim of the raster the top may lie beyond.
        if best in (6, 7, 8, 11, 12, 13, 16, 17, 18):
            step *= 0.5
    return height


def measure(
    model: Bsdf,
    it: Instrument,
    lines: list[tuple[tuple[float, float], list[tuple[float, float]]]],
    *,
    seed: int,
) -> list[tuple[int, float, float, float, float]]:
    """One campaign along given paths: readings, DHR, its u, highest reading, its u, one row an incidence."""
    parts = {**it.parts, "table": lines, "regions": []}
    parts["outputs"] = outputs(it.channels, lamp=it.lamp, of=model.channels)
    records = _native.simulate(
        model,
        incidences=[i for i, _ in lines],
        components=["reflection"],
        seed=seed,
        settings=dict(it.settings),
        parts=parts,
    )
    kinds = {k: [r for r in records if r.kind == k] for k in ("sample", "beam", "dark")}
    found = _native.process(kinds["sample"], beam=kinds["beam"], dark=kinds["dark"])
    rows = []
    for s in found.slices:
        whole, top = s.integrals[0], s.highest("front")
        rows.append((len(s), whole.value, whole.u, top[1], top[2]))
    return rows


def reached(rows: list, truth: float, peak: float) -> Reached:
    n, dhr, u, top, u_top = np.array(rows).T

    def rms(x: np.ndarray) -> float:
        return float(np.sqrt(np.mean(x * x)))

    return Reached(
        float(np.mean(n)), rms(dhr / truth - 1), rms(u / truth), rms(top / peak - 1), rms(u_top / peak)
    )


def planned(
    model: Bsdf, it: Instrument, incidence: tuple[float, float], *, seeds: int, dhr: float, peak: float
) -> list[tuple[int, float, float, float, float]]:
    """Campaigns along planned paths, each of a plan of its own."""
    parts = {**it.parts, "regions": []}
    parts["outputs"] = outputs(it.channels, lamp=it.lamp, of=model.channels)
    rows = []
    for seed in range(1, seeds + 1):
        plan = _native.plan(
            model,
            incidences=[incidence],
            components=["reflection"],
            seed=seed,
            settings=dict(it.settings),
            parts=parts,
            beam_scans=3,
            target_integral=dhr,
            target_peak=peak,
            seconds=None,
            largest_pitch=10.0,
            u_calibration=0.0,
            regions=[],
            watch=lambda _done, _total: None,
        )
        ((theta_i, phi_i, theta, phi),) = plan["table"]
        line = ((theta_i, phi_i), list(zip(theta.tolist(), phi.tolist(), strict=True)))
        rows += measure(model, it, [line], seed=100 + seed)
    return rows


def compared(
    name: str, theta_i: float, *, seeds: int, dhr: float, peak: float
) -> tuple[Reached, list[Reached]]:
    """What planned paths reach, and uniform ones of every pitch."""
    model, it, incidence = material(name), instrument(), (theta_i, 0.0)
    truth = _native.directional_albedo(model, theta_i=theta_i, phi_i=0.0, component="reflection")
    top = true_peak(model, dict(it.settings), *incidence)
    plan = reached(planned(model, it, incidence, seeds=seeds, dhr=dhr, peak=peak), truth, top)
    ladder = []
    for pitch in PITCHES:
        rows = []
        for seed in range(1, seeds + 1):
            rng = np.random.default_rng(1000 * seed + round(10 * pitch))
            line = (incidence, uniform(pitch, it.settings["theta_max"], rng))
            rows += measure(model, it, [line], seed=200 + seed)
        ladder.append(reached(rows, truth, top))
        # Twice in turn as good in all: the rest of the ladder is.
        if (
            all(one.within(plan, claims=claims) for one in ladder[-2:] for claims in (False, True))
            and len(ladder) > 1
        ):
            break
    return plan, ladder


def needed(plan: Reached, ladder: list[Reached], *, claims: bool) -> float:
    """Readings of the coarsest uniform path from which on all are as good; infinite without one."""
    found = np.inf
    for one in reversed(ladder):
        if not one.within(plan, claims=claims):
            break
        found = one.readings
    return found
