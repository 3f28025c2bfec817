"""Known materials through the virtual goniophotometer and back, against the truth as the instrument sees it.

The truth is averaged over beam, spot and aperture here once more, in numpy and from its definition, with
nodes of its own: nothing of the instrument's code is used.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass

import gonio
import numpy as np
from gonio import _native
from gonio._native import FLAGS, UNUSABLE, Bsdf, Slice
from gonio.instruments import Instrument, read_instrument
from gonio.materials import Material
from scipy.stats import qmc

NODES = 256
"""Nodes of the average over the signature."""


def ward(alpha: float) -> dict:
    return {"model": "ward-gmd", "rho": 0.6, "alpha": alpha}


def diffuse(rho: float) -> dict:
    return {"model": "lambert", "rho": rho}


PARTS: dict[str, tuple[list[dict], tuple[str, ...]]] = {
    "Lambert .6": ([diffuse(0.6)], ("reflection",)),
    "Ward-GMD, alpha .02": ([diffuse(0.2), ward(0.02)], ("reflection",)),
    "Ward-GMD, alpha .05": ([diffuse(0.2), ward(0.05)], ("reflection",)),
    "Ward-GMD, alpha .1": ([diffuse(0.2), ward(0.1)], ("reflection",)),
    "Ward-GMD, alpha .3": ([diffuse(0.2), ward(0.3)], ("reflection",)),
    "anisotropic, alpha .05, .2": (
        [
            diffuse(0.1),
            {"model": "ward-gmd-anisotropic", "rho": 0.6, "alpha_x": 0.05, "alpha_y": 0.2, "phi_x": 20.0},
        ],
        ("reflection",),
    ),
    "retro-reflecting, alpha .1": (
        [diffuse(0.3), {"model": "retro-lobe", "kr": 0.3, "alpha_r": 0.1}],
        ("reflection",),
    ),
    "transmitting, alpha .1": (
        [
            diffuse(0.1),
            {"model": "lambert-transmission", "tau": 0.2},
            {"model": "bounded-transmission-lobe", "tau": 0.5, "alpha": 0.1},
        ],
        ("reflection", "transmission"),
    ),
}
"""Materials of the loop: their models and the hemispheres they scatter into."""

INCIDENCES = ((8.0, 0.0), (40.0, 30.0), (65.0, 0.0))


def material(name: str) -> Material:
    """The material of that name in `PARTS`."""
    parts, components = PARTS[name]
    return Material(name, name, _native.analytic(parts), components, INCIDENCES)


def measured(
    it: Material, instrument: Instrument, *, seed: int, settings: dict[str, float] | None = None
) -> gonio.Measurement:
    """One campaign in raw files, read back and processed with what the instrument's data sheet states."""
    with tempfile.TemporaryDirectory() as folder:
        campaign = gonio.simulate(
            material=it, instrument=instrument, settings=settings, seed=seed, out=f"{folder}/raw"
        )
        return gonio.process(
            campaign.sample,
            beam=campaign.beam,
            dark=campaign.dark,
            u_calibration=instrument.u_calibration,
        )


def directions(theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    t, p = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)


def across(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across each of `v`."""
    helper = np.where(np.abs(v[..., 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    a = np.cross(v, helper)
    a /= np.linalg.norm(a, axis=-1, keepdims=True)
    return a, np.cross(v, a)


def disk(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.sqrt(u)[:, None] * np.stack([np.cos(2 * np.pi * v), np.sin(2 * np.pi * v)], axis=-1)


def seen(
    bsdf: Bsdf, settings: dict[str, float], s: Slice, pick: np.ndarray, nodes: int = NODES, seed: int = 1
) -> np.ndarray:
    """The truth as the instrument sees it at the readings `pick`: DSF averaged over its signature.

    A ray comes from a point of a Gaussian beam's image on the detector sphere over a point of the spot, and
    goes to a point of the aperture; its DSF is scaled by the squares of the distances and the angle there.
    """
    r = settings["distance"]
    u = qmc.Sobol(6, seed=seed).random(nodes)
    wi = directions(np.array(s.theta_i), np.array(s.phi_i))
    a, b = across(wi)
    spot = disk(u[:, 0], u[:, 1]) * 0.5 * settings["spot_diameter"]
    x = spot[:, :1] * a + spot[:, 1:] * b
    x = x - wi * (x[:, 2:] / wi[2])
    w = np.radians(settings["beam_half_width"])
    beam = disk(-np.log1p(-u[:, 2]), u[:, 3]) * w
    aim = -wi + beam[:, :1] * a + beam[:, 1:] * b
    aim *= r / np.linalg.norm(aim, axis=1, keepdims=True)
    source = x - aim
    source /= np.linalg.norm(source, axis=1, keepdims=True)
    ws = directions(s.theta_s[pick], s.phi_s[pick])
    c, d = across(ws)
    aperture = disk(u[:, 4], u[:, 5]) * r * np.tan(np.radians(settings["aperture"]))
    total = np.zeros(len(pick))
    for k in range(nodes):
        way = r * ws + aperture[k, 0] * c + aperture[k, 1] * d - x[k]
        length = np.linalg.norm(way, axis=1)
        to = way / length[:, None]
        f = bsdf.eval(
            theta_i=np.degrees(np.arccos(source[k, 2])),
            phi_i=np.degrees(np.arctan2(source[k, 1], source[k, 0])),
            theta_s=np.degrees(np.arccos(np.clip(to[:, 2], -1, 1))),
            phi_s=np.degrees(np.arctan2(to[:, 1], to[:, 0])),
        )
        total += np.asarray(f).reshape(-1) * np.abs(to[:, 2]) * (r / length) ** 2 * np.sum(to * ws, axis=1)
    return total / nodes


@dataclass
class Closure:
    """How claims hold: shares of readings; relative error and expanded uncertainty of integrals."""

    name: str
    readings: int
    held_seen: float
    held_true: float
    median_error: float
    integrals: list[tuple[float, float]]

    @property
    def integrals_held(self) -> int:
        return sum(abs(e) <= u for e, u in self.integrals)


def closure(
    name: str,
    instrument: Instrument,
    *,
    seed: int,
    settings: dict[str, float] | None = None,
    most: int = 2000,
) -> Closure:
    """Measures the material `name` and compares `most` random usable readings an incidence with the truth."""
    it = material(name)
    measurement = measured(it, instrument, seed=seed, settings=settings)
    numbers = {**instrument.settings, **(settings or {})}
    rng = np.random.default_rng(seed)
    held_seen, held_true, errors, integrals, readings = [], [], [], [], 0
    for s in measurement.slices:
        usable = np.flatnonzero((s.flags & UNUSABLE) == 0)
        readings += len(usable)
        pick = np.sort(rng.choice(usable, size=min(most, len(usable)), replace=False))
        truth = it.dsf(theta_i=s.theta_i, phi_i=s.phi_i, theta_s=s.theta_s[pick], phi_s=s.phi_s[pick])
        convolved = seen(it.bsdf, numbers, s, pick)
        off = np.abs(s.dsf[pick] - convolved)
        held_seen.append(off <= 1.96 * s.u_dsf[pick])
        held_true.append(np.abs(s.dsf[pick] - truth) <= 1.96 * s.u_dsf[pick])
        clear = (s.flags[pick] & (FLAGS["negative"] | FLAGS["below_noise"])) == 0
        errors.append(off[clear] / convolved[clear])
        for i in s.integrals:
            whole = it.directional_hemispherical(theta_i=s.theta_i, phi_i=s.phi_i, side=i.side)
            integrals.append(((i.value - whole) / whole, 2.0 * i.u / whole))
    return Closure(
        name,
        readings,
        float(np.mean(np.concatenate(held_seen))),
        float(np.mean(np.concatenate(held_true))),
        float(np.median(np.concatenate(errors))),
        integrals,
    )


def instrument(name: str = "pgII-like") -> Instrument:
    return read_instrument(name)
