"""Every fit model on real materials: held-out errors, and which model the data support."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gonio
import numpy as np
from gonio import _native
from numpy.typing import NDArray

from ..places import SHARED
from . import Skipped, table

RGL = ("chm_orange", "aurora_white", "cm_military_green")
COATINGS = {
    "NiTE on steel, A": "NiTE_on_steel_v1o0A_20250915.xls",
    "AnoBlack on aluminium": "ANOPLATE_AnoBlack_EC1_Alum6061_v1o0_20251115.xls",
}
BLANK = "blank_v2o0_20250911.xls"

INTRODUCTION = """# Fits of real materials

Every fit model on three RGL materials [DupuyJakob2018] (tabulated at their measured incidences, 1 % stated uncertainty) and on
two black coatings (J&C RT-300S, 650 nm, blank subtracted). No sample was turned, so models with an axis are not offered. The
error is the relative L1 difference of the DSF at incidences that were left out of the fit, each in turn, averaged over
incidences and channels; in brackets that of the fit to all incidences. Models are ranked as `gonio fit --model auto` ranks them. Made by `make validate`.

"""


ENDS = """Oren-Nayar's roughness adds light near the incidence; a sample that shows none gets sigma = 0, and the model is Lambert's. A conductor
with k = 0 is a dielectric: its reflectance is Fresnel's where that of the models with `f0` is Schlick's.

"""

PEAKS = """The brightest reading near 45° in the first channel, and the largest angle from it at which the DSF is still a half and a
tenth of it. The ratio of the two radii is 1.8 for a Gaussian, 2.3 for a GGX lobe about the normal, 1 for a disk. A narrow peak that falls
faster than a Gaussian, or lies off the mirror direction, is out of reach of every lobe here: the instrument's own profile, or a tilt of
the sample, is in the readings.

"""


def materials() -> dict[str, gonio.Measurement]:
    """The measurements by name."""
    found: dict[str, gonio.Measurement] = {}
    for name in RGL:
        path = SHARED / "rgl-rgb" / f"{name}_rgb.bsdf"
        found[name] = gonio.tabulate(needed(path), pitch=5.0, peak_pitch=0.3)
    folder = SHARED / "loft-rt300s"
    for name, file in COATINGS.items():
        found[name] = gonio.process(needed(folder / file), dark=needed(folder / BLANK))
    return found


def needed(path: Path) -> Path:
    if not path.exists():
        raise Skipped(f"{path.name} is not on this machine")
    return path


def make() -> str:
    errors: dict[str, dict[str, str]] = {}
    sentences = []
    choices = {}
    measurements = materials()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, measurement in measurements.items():
            choices[name] = _native.select(measurement._data, models=[], settings={})
    for name, choice in choices.items():
        best = choice["ranking"][0][0].model
        for fit, held_out, _ in choice["ranking"]:
            rows = fit.residuals
            own = sum(r["relative_l1"] for r in rows) / len(rows)
            text = f"{100 * held_out:.1f} ({100 * own:.1f})" if math.isfinite(held_out) else "–"
            errors.setdefault(fit.model, {})[name] = f"**{text}**" if fit.model == best else text
        for model, reason in choice["failed"].items():
            errors.setdefault(model, {})[name] = "no fit"
            sentences.append(f"- {name}, {model}: {reason}")
        sentences.insert(0, f"- {name}: {choice['sentence']}")
    order = sorted(errors, key=lambda m: mean_error(errors[m]))
    rows = [[f"`{m}`", *(errors[m].get(name, "–") for name in choices)] for m in order]
    parameters = []
    for name, choice in choices.items():
        best = choice["ranking"][0][0]
        for e in best.estimates:
            channel = f", {e['channel']}" if e["channel"] else ""
            parameters.append(
                [
                    name,
                    best.model,
                    f"{e['name']}{channel}",
                    f"{e['value']:.4g}",
                    f"{e['u']:.1g}",
                    f"{e['u_model']:.1g}",
                    e["kind"],
                ]
            )
    return (
        INTRODUCTION
        + table(["model", *(f"{n}, %" for n in choices)], rows)
        + "\n## What the peaks look like\n\n"
        + PEAKS
        + table(
            ["material", "theta_i", "peak off the mirror direction", "radius at 1/2", "at 1/10", "ratio"],
            [[name, *peak(measurement)] for name, measurement in measurements.items()],
        )
        + "\n## Where searches end at a bound, or not at all\n\n"
        + ENDS
        + table(
            ["material", "sigma = 0", "k = 0", "not converged"],
            [[name, *ends(choice)] for name, choice in choices.items()],
        )
        + "\n## What the comparison says\n\n"
        + "\n".join(sorted(sentences))
        + "\n\n## Parameters of the best model\n\n`u` is the standard uncertainty from noise and correlated residuals, `u_model` "
        "the spread between metrics: what the model, not the noise, leaves open.\n\n"
        + table(["material", "model", "parameter", "value", "u", "u_model", "kind"], parameters)
    )


def peak(measurement: gonio.Measurement) -> list[str]:
    """Where the brightest reading of the slice nearest to 45 degrees lies, and how fast the DSF falls around it."""
    s = min(measurement.slices, key=lambda s: abs(s.theta_i - 45.0))
    v = units(s.theta_s, s.phi_s)
    top = int(np.nanargmax(s.dsf))
    mirror = units(np.array([s.theta_i]), np.array([s.phi_i + 180.0]))[0]
    from_top = np.degrees(np.arccos(np.clip(v @ v[top], -1.0, 1.0)))
    offset = np.degrees(np.arccos(np.clip(v[top] @ mirror, -1.0, 1.0)))
    half, tenth = (float(from_top[s.dsf >= share * s.dsf[top]].max()) for share in (0.5, 0.1))
    return [f"{s.theta_i:.1f}°", f"{offset:.2f}°", f"{half:.2f}°", f"{tenth:.2f}°", f"{tenth / half:.1f}"]


def units(theta: NDArray[np.float64], phi: NDArray[np.float64]) -> NDArray[np.float64]:
    t, p = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=1)


def ends(choice: dict[str, Any]) -> list[str]:
    """The models with sigma at 0, those with k at 0, and those whose search did not converge."""
    fits = [fit for fit, _, _ in choice["ranking"]]

    def models(holds: Callable[[Any], bool]) -> str:
        return ", ".join(sorted(f"`{fit.model}`" for fit in fits if holds(fit))) or "–"

    def at_zero(parameter: str) -> Callable[[Any], bool]:
        def holds(fit: Any) -> bool:
            values = [e["value"] for e in fit.estimates if e["name"] == parameter]
            return bool(values) and max(values) < 1e-3

        return holds

    def unsettled(fit: Any) -> bool:
        return any(code == "not_converged" for code, _ in fit.warnings)

    return [models(at_zero("sigma")), models(at_zero("k")), models(unsettled)]


def mean_error(of: dict[str, str]) -> float:
    values = [float(v.strip("*").split()[0]) for v in of.values() if v[0].isdigit() or v[0] == "*"]
    return sum(values) / len(values) if values else math.inf
