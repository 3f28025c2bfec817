"""Values and samples of tensor trees: gonio against RADIANCE's BSDF library on the same files.

A tree of rank 3 (64 cells an edge) and one of rank 4 (32) of a diffuse material with a lobe, written as XML
and read by both. Evaluation: random pairs of directions, double precision arrays in and out. Sampling: a
direction of incidence of its own for every sample, so that every sample needs other tables; both have built
them all before. RADIANCE's calls are looped over in C. CPU seconds of this process, medians of alternating
pairs; the ratio is of the sums over both trees.
"""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from gonio import _native

from bench._radiance import Array, Library
from bench._timing import cpu_seconds

IDS = ("tree-eval-vs-radiance", "tree-sample-vs-radiance")
EVALUATIONS, SAMPLES, PAIRS = 3_000_000, 1_000_000, 5
ISOTROPIC = [{"model": "lambert", "rho": 0.3}, {"model": "ward-gmd", "rho": 0.4, "alpha": 0.1}]
BRUSHED = [
    {"model": "lambert", "rho": 0.2},
    {"model": "ward-gmd-anisotropic", "rho": 0.5, "alpha_x": 0.08, "alpha_y": 0.25, "phi_x": 0.0},
]
TREES = {"rank 3": (ISOTROPIC, 3, 6), "rank 4": (BRUSHED, 4, 5)}


def directions(n: int, most: float, seed: int) -> Array:
    """Unit vectors (n, 3), evenly over the front up to the polar angle `most` in degrees."""
    rng = np.random.default_rng(seed)
    z = 1 - (1 - np.cos(np.radians(most))) * rng.random(n)
    phi, r = 2 * np.pi * rng.random(n), np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)


def pairs(ours: Callable[[], Any], theirs: Callable[[], Any]) -> tuple[float, float]:
    """Median CPU seconds of both, after a first call of each."""
    ours(), theirs()
    found = [(cpu_seconds(ours), cpu_seconds(theirs)) for _ in range(PAIRS)]
    return tuple(statistics.median(column) for column in zip(*found, strict=True))  # type: ignore[return-value]


def tree(parts: Any, rank: int, depth: int, path: Path) -> _native.TensorTree:
    """The tree that the XML file holds."""
    reduced = _native.to_tensor_tree(
        _native.analytic(parts), rank=rank, max_depth=depth, components=[("front", "reflection")]
    )
    _native.write_radiance_xml(path, reduced, name="benchmark")
    found = _native.read_radiance_xml(path)
    assert isinstance(found, _native.TensorTree)
    return found


def run() -> list[dict[str, Any]]:
    try:
        library = Library()
    except (FileNotFoundError, ImportError) as missing:
        print(f"tree benchmarks: skipped, {missing}")
        return []
    wi, ws = directions(EVALUATIONS, 85, 1), directions(EVALUATIONS, 89, 2)
    incident, u = directions(SAMPLES, 85, 3), np.random.default_rng(4).random((SAMPLES, 3))
    one = np.ascontiguousarray(u[:, 0])
    # Each library gets the layout that it reads in place.
    columns = [np.ascontiguousarray(v.T) for v in (wi, ws)]
    times: dict[str, dict[str, tuple[float, float]]] = {"eval": {}, "sample": {}}
    with tempfile.TemporaryDirectory() as folder:
        for name, (parts, rank, depth) in TREES.items():
            path = Path(folder) / f"{rank}.xml"
            model, peer = tree(parts, rank, depth, path), library.load(path)
            # RADIANCE shifts its values by up to 2e-4; a pair on the edge of a cell may fall to either side.
            values = model.eval_directions(wi=wi, ws=ws)[0]
            other = library.eval(peer, wi, ws)
            assert np.mean(np.abs(values - other) > 1e-3 * other + 1e-9) < 1e-4
            drawn, theirs = model.sample_directions(wi=incident, u=u), library.sample(peer, incident, one)
            np.testing.assert_allclose(drawn["weight"].mean(), theirs[1].mean(), rtol=0.01)
            # Default arguments hold this round's objects.
            times["eval"][name] = pairs(
                lambda m=model: m.eval_directions(wi=columns[0], ws=columns[1]),
                lambda p=peer: library.eval(p, wi, ws),
            )
            times["sample"][name] = pairs(
                lambda m=model: m.sample_directions(wi=incident, u=u),
                lambda p=peer: library.sample(p, incident, one),
            )
    records = []
    for id_, (kind, n) in zip(IDS, (("eval", EVALUATIONS), ("sample", SAMPLES)), strict=True):
        ours, theirs = (sum(t[k] for t in times[kind].values()) for k in (0, 1))
        records.append(
            {
                "id": id_,
                "ours": ours,
                "peer": theirs,
                "peer_name": "RADIANCE SDevalBSDF" if kind == "eval" else "RADIANCE SDsampBSDF",
                "ratio": theirs / ours,
                "unit": "CPU s",
                "command": f"python -m bench {id_}",
                "calls_each": n,
                "trees": {name: {"ours": t[0], "peer": t[1]} for name, t in times[kind].items()},
            }
        )
    return records
