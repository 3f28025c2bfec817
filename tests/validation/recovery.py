"""Fits of simulated campaigns of random known materials: do the stated intervals hold the truth?"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from gonio import _native

INCIDENCES = ((10.0, 0.0), (35.0, 0.0), (60.0, 0.0))
TURNED = ((15.0, 0.0), (40.0, 30.0), (40.0, 120.0), (60.0, 75.0))
"""Incidences for models with an axis."""

PATH = {"pitch_across": 8.0, "pitch_along": 2.0, "patch_pitch": 1.0, "spot_diameter": 0.004}
"""A sparse path of some 2500 readings an incidence; a small spot, whose parallax the signature lacks."""

RANGES = {
    "color": (0.1, 0.9),
    "specularity": (0.03, 0.2),
    "trans": (0.3, 0.7),
    "tspec": (0.3, 0.7),
    "kd": (0.05, 0.5),
    "ks": (0.05, 0.4),
    "td": (0.05, 0.4),
    "ts": (0.1, 0.4),
    "rho": (0.1, 0.8),
    "rho_d": (0.1, 0.5),
    "f0": (0.03, 0.4),
    "roll_off": (0.03, 0.2),
    "g": (1.5, 3.5),
    "sigma": (8.0, 40.0),
    "phi_x": (-40.0, 40.0),
    "eta": (1.3, 2.0),
    "k": (1.0, 4.0),
}
"""Ranges of the random parameters; widths are even in their logarithm."""

WIDTHS = (0.05, 0.35)


@dataclass
class Recovery:
    """How often the 95 % interval of each parameter held the truth."""

    model: str
    sets: int = 0
    held: dict[str, int] = field(default_factory=dict)
    tried: dict[str, int] = field(default_factory=dict)
    z: dict[str, list[float]] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)

    @property
    def share(self) -> float:
        """Share of all parameters of all sets whose interval holds."""
        return sum(self.held.values()) / max(1, sum(self.tried.values()))

    def add(self, outcome: Outcome) -> None:
        """Counts one set. A limit holds where its interval does; only values have an error in units of u."""
        self.sets += 1
        if outcome.error is not None:
            self.failed.append(outcome.error)
        for e in outcome.estimates:
            name, value = e["name"], outcome.truth[e["name"]]
            self.tried[name] = self.tried.get(name, 0) + 1
            self.held[name] = self.held.get(name, 0) + (e["low"] <= value <= e["high"])
            if e["kind"] == "value":
                self.z.setdefault(name, []).append((e["value"] - value) / e["u"])


@dataclass(frozen=True)
class Outcome:
    """A material and what a fit says of it."""

    truth: dict[str, float]
    estimates: list[dict]
    error: str | None = None


def random_parameters(model: dict, rng: np.random.Generator) -> dict[str, float]:
    """Parameters of an ordinary material; an anisotropic one is wider along y by a factor of 1.5 to 3."""
    drawn = {}
    for p in model["parameters"]:
        low, high = RANGES.get(p["name"].rstrip("_123456789"), (p["low"], p["high"]))
        if p["role"] == "width" and p["name"] != "roll_off":
            drawn[p["name"]] = float(np.exp(rng.uniform(*np.log(WIDTHS))))
        else:
            drawn[p["name"]] = float(rng.uniform(low, high))
    if "alpha_y" in drawn:
        drawn["alpha_x"] = float(np.exp(rng.uniform(np.log(0.05), np.log(0.12))))
        drawn["alpha_y"] = drawn["alpha_x"] * float(rng.uniform(1.5, 3.0))
    return drawn


def components(parts: list[str]) -> list[str]:
    known = {m["name"]: m["scatters"] for m in _native.model_families()}
    found = {known[p] for p in parts}
    both = "both" in found or len(found) == 2
    return ["reflection", "transmission"] if both else [found.pop()]


def campaign(model: dict, truth: dict[str, float], seed: int) -> _native.MeasurementData:
    """The material of `truth` measured and processed."""
    bsdf = _native.fit_model_bsdf(model["name"], {"photopic": truth})
    scans = _native.simulate(
        bsdf,
        incidences=TURNED if "phi_x" in truth else INCIDENCES,
        components=components(model["parts"]),
        seed=seed,
        started="2026-01-05T08:00:00Z",
        settings=PATH,
    )
    of = {k: [s for s in scans if s.kind == k] for k in ("sample", "beam", "dark")}
    return _native.process(of["sample"], beam=of["beam"], dark=of["dark"])


def outcomes(model: dict, sets: int) -> Iterator[Outcome]:
    """Fits `sets` random materials of `model` with the model itself; each model has a seed of its own."""
    seed = zlib.crc32(model["name"].encode()) % 100_000
    rng = np.random.default_rng(seed)
    for k in range(sets):
        truth = random_parameters(model, rng)
        measured = campaign(model, truth, 1000 * seed + k)
        try:
            fit = _native.fit(measured, model=model["name"], settings={"compare": []})
        except _native.FitError as error:
            yield Outcome(truth, [], str(error))
        else:
            yield Outcome(truth, fit.estimates)


def recover(model: dict, sets: int) -> Recovery:
    """The coverage of `sets` random materials of `model`."""
    found = Recovery(model["name"])
    for outcome in outcomes(model, sets):
        found.add(outcome)
    return found
