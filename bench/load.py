"""A scene of a million triangles: `load-1m`, reading a mesh in PLY and building the tree.

Seconds of the wall clock on all processors from the file to a scene that can be rendered, with CPU seconds,
and the growth of the resident memory per triangle, what reading needs in between included (`peak`) and as it
stays. The limits are 3 s and 200 bytes.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

IDS = ("load-1m",)
ROWS = 1000
COLUMNS = 500
RUNS = 3
LIMIT = 3.0

READER = """
import json, resource, sys, time
from pathlib import Path
import gonio

def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()

gonio.read_scene(sys.argv[2])
before, start, cpu = resident(), time.perf_counter(), time.process_time()
scene, _ = gonio.read_scene(sys.argv[1])
wall, cpu = time.perf_counter() - start, time.process_time() - cpu
count = scene.primitives
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
found = {"wall": wall, "cpu": cpu, "triangles": count}
found |= {"bytes": (resident() - before) / count, "peak": (peak - before) / count}
print(json.dumps(found))
"""


def write_mesh(path: Path) -> None:
    """A displaced sphere of 2 x ROWS x COLUMNS triangles, binary."""
    theta, phi = np.meshgrid(
        np.linspace(0.05, np.pi - 0.05, ROWS + 1), np.linspace(0, 2 * np.pi, COLUMNS, False), indexing="ij"
    )
    radius = 1.0 + 0.05 * np.sin(23 * theta) * np.cos(17 * phi)
    points = np.stack(
        [
            radius * np.sin(theta) * np.cos(phi),
            radius * np.sin(theta) * np.sin(phi),
            radius * np.cos(theta),
        ],
        axis=-1,
    ).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(ROWS), np.arange(COLUMNS), indexing="ij")
    a, b = i * COLUMNS + j, i * COLUMNS + (j + 1) % COLUMNS
    corners = np.stack([a, a + COLUMNS, b, b, a + COLUMNS, b + COLUMNS], axis=-1).reshape(-1, 3)
    faces = np.empty(len(corners), np.dtype([("n", "u1"), ("corner", "<i4", 3)]))
    faces["n"], faces["corner"] = 3, corners
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + points.astype("<f4").tobytes() + faces.tobytes())


def run() -> list[dict[str, Any]]:
    with tempfile.TemporaryDirectory() as folder:
        write_mesh(Path(folder) / "mesh.ply")
        stuff = "void plastic stuff\n0\n0\n5 .5 .5 .5 0 0\n"
        scene, small = Path(folder) / "scene.rad", Path(folder) / "small.rad"
        scene.write_text(stuff + "stuff mesh big\n1 mesh.ply\n0\n0\n")
        small.write_text(stuff + "stuff sphere one\n0\n0\n4 0 0 0 1\n")
        command = [sys.executable, "-c", READER, str(scene), str(small)]
        found = [
            json.loads(
                subprocess.run(
                    command, capture_output=True, text=True, check=True, env=dict(os.environ)
                ).stdout
            )
            for _ in range(RUNS)
        ]
    median = {k: statistics.median(f[k] for f in found) for k in found[0]}
    return [
        {
            "id": "load-1m",
            "ours": median["wall"],
            "peer": LIMIT,
            "peer_name": "limit",
            "ratio": LIMIT / median["wall"],
            "unit": "s",
            "cpu_s": median["cpu"],
            "triangles": median["triangles"],
            "bytes_per_triangle": median["bytes"],
            "peak_bytes_per_triangle": median["peak"],
            "command": "python -m bench load-1m",
        }
    ]
