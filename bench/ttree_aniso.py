"""A data-driven model of an anisotropic material as a tensor tree of rank 4: gonio against bsdf2ttree.

The elliptic Ward lobe of `bench.aniso`, 26 incidences of 19,000 readings. RADIANCE: pabopto2bsdf, then
bsdf2ttree -g 5, once (minutes). gonio: build and reduction to as many bytes as that file has. CPU
seconds of model to file; those of files to model are in the record, as are the errors, mean and worst
over the incidences that `bench.aniso` holds out: relative L1 and root mean square of the DSF over solid
angle.

A folder named by `GONIO_PEER_TREE` keeps RADIANCE's model.sir, model.xml and cpu.json between runs.
"""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from gonio import _native

from bench._anisotropic import SAMPLES, readings
from bench._materials import direction
from bench._timing import seconds
from bench.aniso import SEED, errors, mean_and_worst, measurement, of_model, write
from bench.export import FRONT, peer_seconds

IDS = ("ttree-aniso-vs-bsdf2ttree",)
NAME = "ward"
XML = 1200
"""Bytes of a file that are not the tree's."""


def peer(folder: Path) -> list[float]:
    """RADIANCE's model and tree of the readings, made where they are not there yet; CPU seconds of both."""
    kept = folder / "cpu.json"
    if not kept.exists():
        sample = SAMPLES[NAME]
        names = write(sample, readings(sample, sample.incidences(), SEED), folder)
        spent = [peer_seconds(folder, "model.sir", "pabopto2bsdf", *names)]
        spent.append(peer_seconds(folder, "model.xml", "bsdf2ttree", "-g", "5", "model.sir"))
        kept.write_text(json.dumps(spent))
    found: list[float] = json.loads(kept.read_text())
    return found


def quality(model: _native.Bsdf) -> dict[str, tuple[float, float]]:
    """Errors of a model at the incidences that were not measured: mean and worst."""
    sample = SAMPLES[NAME]
    found = of_model(model, transmits=False)
    each = [errors(sample, found, direction(*incidence)) for incidence in sample.held_out()]
    return {key: mean_and_worst(each, key) for key in ("rel_l1", "rms", "peak", "share")}


def run() -> list[dict[str, Any]]:
    sample = SAMPLES[NAME]
    with tempfile.TemporaryDirectory() as own:
        folder = Path(os.environ.get("GONIO_PEER_TREE", own))
        to_sir, to_tree = peer(folder)
        size = (folder / "model.xml").stat().st_size
        tree = _native.read_radiance_xml(folder / "model.xml")
        measured = measurement(sample, readings(sample, sample.incidences(), SEED))
        build, model = seconds(lambda: _native.build(measured, symmetry="anisotropic"))
        path = Path(own) / "ours.xml"

        def export() -> None:
            reduced = _native.to_tensor_tree(
                model, rank=4, components=FRONT, max_bytes=size - XML, max_depth=8
            )
            _native.write_radiance_xml(path, reduced, name=NAME)

        spent, _ = seconds(export)
        ours = _native.read_radiance_xml(path)
        sizes = [path.stat().st_size, size]
    return [
        {
            "id": IDS[0],
            "ours": spent,
            "peer": to_tree,
            "peer_name": "RADIANCE bsdf2ttree -g 5",
            "ratio": to_tree / spent,
            "unit": "CPU s",
            "command": f"python -m bench {IDS[0]}",
            "files_to_model": [build, to_sir],
            "bytes": sizes,
            "full_model": quality(model),
            "ours_errors": quality(ours),
            "peer_errors": quality(tree),
        }
    ]
