"""Every fit model on real materials: held-out errors, and which model the data support."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import gonio
from gonio import _native

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
two black coatings (J&C RT-300S, 650 nm, blank subtracted). The error is the relative L1 difference of the DSF at
incidences that were left out of the fit, each in turn, averaged over incidences and channels; in brackets that of the fit
to all incidences. Models are ranked as `gonio fit --model auto` ranks them. Made by `make validate`.

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
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, measurement in materials().items():
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
        + "\n## What the comparison says\n\n"
        + "\n".join(sorted(sentences))
        + "\n\n## Parameters of the best model\n\n`u` is the standard uncertainty from noise and correlated residuals, `u_model` "
        "the spread between metrics: what the model, not the noise, leaves open.\n\n"
        + table(["material", "model", "parameter", "value", "u", "u_model", "kind"], parameters)
    )


def mean_error(of: dict[str, str]) -> float:
    values = [float(v.strip("*").split()[0]) for v in of.values() if v[0].isdigit() or v[0] == "*"]
    return sum(values) / len(values) if values else math.inf
