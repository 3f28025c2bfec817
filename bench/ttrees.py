"""The error of tensor trees of one size: gonio's against bsdf2ttree's of the same readings.

The isotropic materials and readings of `bench.models`. RADIANCE makes its tree with `pabopto2bsdf` and
`bsdf2ttree -g 6`, gonio builds its model and reduces it to as many bytes as that XML file has. Errors
are relative L1 of the DSF against the material itself, mean over 15, 25 to 75 degrees (held out) and 20,
30 to 70 degrees (measured); the ratio is of the geometric means over the six materials with lobes about
the mirror direction. The same with `-g 5` and `-g 7` for two of them is in the record.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from gonio import _native

from bench._materials import ISOTROPIC, Array, Brdf, readings
from bench._timing import seconds
from bench.export import FRONT, peer_seconds
from bench.models import KINDS, MEASURED, measurement, of_model, outgoing, peer, rel_l1

IDS = ("ttree-bytes-vs-bsdf2ttree",)
OTHERS = ("5", "7")
"""Fineness of further trees, of the materials in `FURTHER`."""
FURTHER = ("gloss", "metal")
XML = 1200
"""Bytes of a file that are not the tree's."""


def error(material: Brdf, model: _native.Bsdf, w: Array) -> float:
    """Mean relative L1 difference over held-out and measured incidences."""
    found = of_model(model)
    return float(np.mean([rel_l1(material, found, t, w) for t in KINDS["held_out"] + KINDS["measured"]]))


def ours(model: _native.Bsdf, size: int, path: Path) -> tuple[float, _native.Bsdf]:
    """CPU seconds of reduction and writing, and the tree of at most `size` bytes."""

    def write() -> None:
        reduced = _native.to_tensor_tree(model, components=FRONT, max_bytes=size - XML, max_depth=10)
        _native.write_radiance_xml(path, reduced, name="benchmark")

    spent, _ = seconds(write)
    assert path.stat().st_size <= size, (path.stat().st_size, size)
    return spent, _native.read_radiance_xml(path)


def run() -> list[dict[str, Any]]:
    w = outgoing()
    rows: dict[str, dict[str, Any]] = {}
    for name, material in ISOTROPIC.items():
        if name == "redirecting":  # RADIANCE's tree takes reciprocity for granted
            continue
        data = {t: readings(material, t, 20261122) for t in MEASURED}
        model = _native.build(measurement(data), symmetry="isotropic")
        with tempfile.TemporaryDirectory() as folder:
            where = Path(folder)
            _, tree = peer(data, where)
            for fineness in ("6", *(OTHERS if name in FURTHER else ())):
                if fineness != "6":
                    peer_seconds(where, "model.xml", "bsdf2ttree", "-g", fineness, "model.sir")
                    tree = _native.read_radiance_xml(where / "model.xml")
                size = (where / "model.xml").stat().st_size
                spent, reduced = ours(model, size, where / "ours.xml")
                rows[f"{name} -g {fineness}"] = {
                    "bytes": [(where / "ours.xml").stat().st_size, size],
                    "ours": error(material, reduced, w),
                    "peer": error(material, tree, w),
                    "full_model": error(material, model, w),
                    "cpu": spent,
                }

    def mean(which: str) -> float:
        return math.exp(np.mean([math.log(r[which]) for key, r in rows.items() if key.endswith("-g 6")]))

    return [
        {
            "id": IDS[0],
            "ours": mean("ours"),
            "peer": mean("peer"),
            "peer_name": "RADIANCE pabopto2bsdf, bsdf2ttree -g 6",
            "ratio": mean("peer") / mean("ours"),
            "unit": "relative L1",
            "command": f"python -m bench {IDS[0]}",
            "trees": rows,
        }
    ]
