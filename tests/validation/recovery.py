"""Fits of simulated campaigns of random known materials: do the stated intervals hold the truth?"""

from __future__ import annotations

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
    held: dict[str, int] = field(default_factory=dict)
    tried: dict[str, int] = field(default_factory=dict)
    z: dict[str, list[float]] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    other_kinds: dict[str, int] = field(default_factory=dict)

    @property
    def share(self) -> float:
        """Share of all parameters of all sets whose interval holds."""
        return sum(self.held.values()) / max(1, sum(self.tried.values()))

    def count(self, name: str, *, held: bool, z: float) -> None:
        self.tried[name] = self.tried.get(name, 0) + 1
        self.held[name] = self.held.get(name, 0) + held
        self.z.setdefault(name, []).append(z)


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


def recover(model: dict, sets: int, seed: int) -> Recovery:
    """Fits `sets` random materials of `model` with the model itself."""
    rng = np.random.default_rng(seed)
    found = Recovery(model["name"])
    for k in range(sets):
        truth = random_parameters(model, rng)
        measured = campaign(model, truth, 1000 * seed + k)
        try:
            fit = _native.fit(measured, model=model["name"], settings={"compare": []})
        except _native.FitError as error:
            found.failed.append(str(error))
            continue
        for e in fit.estimates:
            name, value = e["name"], truth[e["name"]]
            if e["kind"] == "value":
                found.count(name, held=e["low"] <= value <= e["high"], z=(e["value"] - value) / e["u"])
            elif e["kind"] == "upper_limit":
                found.count(name, held=value <= e["high"], z=0.0)
            else:
                found.other_kinds[name] = found.other_kinds.get(name, 0) + 1
    return found
