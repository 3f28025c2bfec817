"""What compact models weigh and lose, of synthetic and of real materials."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import gonio
from gonio import _native

from bench._anisotropic import SAMPLES
from bench._anisotropic import readings as readings_of_sample
from bench._materials import ISOTROPIC, readings
from bench.aniso import SEED
from bench.aniso import measurement as measurement_of_sample
from bench.models import MEASURED, measurement
from tests.validation.places import SHARED

from . import Skipped, table

THETA_I = (0.0, 7.0, 22.0, 37.0, 52.0, 67.0, 75.0)
PHI_I = (0.0, 40.0, 80.0, 130.0)
ANISOTROPIC = ("ward", "two-axes")
RGL = ("aurora_white", "cm_military_green", "chm_orange", "irid_flake_paint1")
TEXT = """# Compact models: bytes and loss

Made by `python -m tests.validation compact`. Front reflection, default target (0.5 %) and default limits of bytes. Bytes are those of the
table of one channel. Relative L1 is ∫|f' − f| cos dω / ∫ f cos dω against the model that was reduced, mean over
0, 7, 22, 37, 52, 67 and 75° (four azimuths where there are axes) and the largest of them.

Data-driven models: those of `python -m bench heldout-iso-vs-radiance-ttree` (8 incidences of some 40,000 readings) and
`python -m bench.aniso` (26 or 41 incidences of 19,000), noise 1 % and 2·10⁻⁴ sr⁻¹. RGL: the RGB tensors of the RGL material database
[DupuyJakob2018], first channel.

{table}"""


def models() -> Iterator[tuple[str, str, Any]]:
    """Name, kind and model."""
    for name, material in ISOTROPIC.items():
        data = {t: readings(material, t, 20261122) for t in MEASURED}
        yield name, "data-driven, isotropic", _native.build(measurement(data), symmetry="isotropic")
    for name in ANISOTROPIC:
        sample = SAMPLES[name]
        data = readings_of_sample(sample, sample.incidences(), SEED)
        model = _native.build(measurement_of_sample(sample, data), symmetry="anisotropic")
        yield name, "data-driven, with axes", model
    for name in RGL:
        yield name, "RGL", gonio.read_bsdf(SHARED / "rgl-rgb" / f"{name}_rgb.bsdf")


def row(name: str, kind: str, model: Any) -> list[str]:
    """One line of the table."""
    channel = model.channels[0]
    reduced = _native.to_compact(model, channels=[channel], components=[("front", "reflection")])
    azimuths = (0.0,) if model.properties["isotropic"] else PHI_I
    losses = [
        _native.reduction_loss(model, reduced, theta_i=t, phi_i=p, channel=channel, grid=300)["rel_l1"]
        for t in THETA_I
        for p in azimuths
    ]
    losses = [value for value in losses if math.isfinite(value)]
    part = reduced.parts()[0]
    return [
        name,
        kind,
        f"{part['symmetry']}, {' × '.join(map(str, part['codes'].shape[1:]))}",
        f"{sum(reduced.bytes_per_channel.values()):,}",
        f"{100 * sum(losses) / len(losses):.2f} %",
        f"{100 * max(losses):.2f} %",
    ]


def make() -> str:
    """The page."""
    if not (SHARED / "rgl-rgb").exists():
        raise Skipped("the RGL materials are not on this machine")
    rows = []
    for name, kind, model in models():
        rows.append(row(name, kind, model))
        print(rows[-1], flush=True)
    head = ["material", "full model", "table", "bytes a channel", "relative L1", "largest"]
    return TEXT.format(table=table(head, rows))
