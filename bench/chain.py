"""One million readings of one incidence: a Mountain file to DSF and DHR, CPU seconds and peak memory.

Runs in a fresh process, so that the peak is this work's alone. The peer is the project's own limit.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from bench.weights import rings

IDS = ["chain-1m", "chain-1m-memory"]
LIMIT_SECONDS = 4.0
LIMIT_MEMORY = 6.0
"""Peak memory allowed, as a multiple of the three columns of numbers."""

CHILD = """
import json, resource, sys, time
import gonio

def peak():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

before, start = peak(), time.process_time()
measurement = gonio.process(sys.argv[1])
seconds = time.process_time() - start
(part,) = measurement.slices
(integral,) = part.integrals
found = {"seconds": seconds, "bytes": peak() - before, "readings": len(part), "dhr": integral.value}
print(json.dumps(found))
"""


def write_file(path: Path) -> int:
    """One million readings on rings of a known material; returns their number."""
    theta, phi = rings(1_000_000)
    dsf = np.cos(np.radians(theta)) * 0.8 / np.pi
    with path.open("w") as file:
        file.write("#sample_name bench\n#format: theta phi DSF\n#incident_angle 30 180\n#upphi 90\n")
        np.savetxt(file, np.column_stack([theta, phi, dsf]), fmt=["%.4f", "%.4f", "%.6e"], delimiter="\t")
    return len(theta)


def run() -> list[dict[str, Any]]:
    """Records `chain-1m` (CPU seconds) and `chain-1m-memory` (peak over the numeric data)."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mountain.txt"
        readings = write_file(path)
        done = [
            json.loads(
                subprocess.run(
                    [sys.executable, "-c", CHILD, str(path)], check=True, capture_output=True, text=True
                ).stdout
            )
            for _ in range(3)
        ]
    if abs(done[0]["dhr"] - 0.8) > 0.004:
        raise AssertionError(f"DHR of a Lambertian sample of .8: {done[0]['dhr']}")
    seconds = sorted(d["seconds"] for d in done)[1]
    memory = sorted(d["bytes"] for d in done)[1] / (24 * readings)
    common = {"peer_name": "the project's own limit", "command": "python -m bench chain-1m"}
    return [
        {
            "id": "chain-1m",
            "ours": seconds,
            "peer": LIMIT_SECONDS,
            "ratio": LIMIT_SECONDS / seconds,
            "unit": "CPU s",
        }
        | common,
        {
            "id": "chain-1m-memory",
            "ours": memory,
            "peer": LIMIT_MEMORY,
            "ratio": LIMIT_MEMORY / memory,
            "unit": "times the numeric data",
        }
        | common,
    ]
