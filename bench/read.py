"""A Mountain file of 1,000,000 lines into numpy arrays: gonio against pandas' C engine and numpy.loadtxt.

CPU seconds (user and system) of this process around each call; the median of pairs that alternate within one
run, after one call of each to warm the page cache and the allocators.
"""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path
from typing import Any

import gonio
import numpy as np
import pandas as pd

from bench._timing import cpu_seconds

IDS = ("read-mountain-vs-pandas", "read-mountain-vs-loadtxt")
LINES = 1_000_000


def write_file(path: Path) -> None:
    """Random directions of the hemisphere with a smooth value, as an instrument prints them."""
    rng = np.random.default_rng(20261122)
    theta = np.degrees(np.arccos(rng.random(LINES)))
    phi = 360 * rng.random(LINES)
    rows = np.column_stack([theta, phi, 0.3 + np.exp(-theta / 20)])
    header = "#sample_name bench\n#format: theta phi BSDF\n#incident_angle 30 0\n#upphi 90\n"
    with path.open("w") as file:
        file.write(header)
        np.savetxt(file, rows, fmt=["%.4f", "%.4f", "%.6e"], delimiter="\t")


def by_gonio(path: Path) -> list[np.ndarray]:
    (scan,) = gonio.read(path)
    return [scan.theta_s, scan.phi_s, scan.value]


def by_pandas(path: Path) -> list[np.ndarray]:
    table = pd.read_csv(path, engine="c", sep=r"\s+", comment="#", header=None)
    return [table[k].to_numpy() for k in range(3)]


def by_loadtxt(path: Path) -> list[np.ndarray]:
    return list(np.loadtxt(path, unpack=True))


def run() -> list[dict[str, Any]]:
    records = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mountain.txt"
        write_file(path)
        reference = by_pandas(path)
        for ours, theirs in zip(by_gonio(path), reference, strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-12)
        for name, peer, peer_name, pairs in (
            (IDS[0], by_pandas, f"pandas {pd.__version__} C engine", 9),
            (IDS[1], by_loadtxt, f"numpy.loadtxt {np.__version__}", 5),
        ):
            times = [
                (cpu_seconds(lambda: by_gonio(path)), cpu_seconds(lambda p=peer: p(path)))
                for _ in range(pairs)
            ]
            records.append(
                {
                    "id": name,
                    "ours": statistics.median(a for a, _ in times),
                    "peer": statistics.median(b for _, b in times),
                    "peer_name": peer_name,
                    "ratio": statistics.median(b / a for a, b in times),
                    "unit": "CPU s",
                    "command": f"python -m bench {name}",
                }
            )
    return records
