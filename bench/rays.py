"""A million rays through a closed room of displaced spheres: gonio against Embree in its robust mode.

`rays-100k-vs-embree-robust`, `rays-1m-vs-embree-robust`: nearest hits of rays that a diffuse surface
scatters, in single precision, one thread, CPU seconds, medians of pairs that alternate in one run;
`ratio_primary` is the same of rays from one point. The rays are those that gonio's own program
(crates/trace/examples/rays.rs) traces, handed over in files. gonio is built as users build it, for any
x86-64. Both must lose no ray.
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

ROOT = Path(__file__).parent.parent
SIZES = {"rays-100k-vs-embree-robust": 100_000, "rays-1m-vs-embree-robust": 1_000_000}
IDS = tuple(SIZES)
PAIRS = 7

PEER = """
import json, sys, time
import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

def load(name):
    return np.fromfile(f"{sys.argv[1]}/{name}.f32", np.float32)

scene = EmbreeScene(robust=True)
TriangleMesh(scene, load("triangles").reshape(-1, 3, 3))
scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))
found = {}
for name in ("primary", "bounce"):
    origins, directions = (load(f"{name}-{part}").reshape(-1, 3) for part in "od")
    start = time.process_time()
    hits = scene.run(origins, directions)
    found[name] = len(origins) / (time.process_time() - start) / 1e6
    found[f"{name}_missed"] = int((hits < 0).sum())
print(json.dumps(found))
"""


def program() -> Path:
    """gonio's program, built for any processor of this kind."""
    command = ["cargo", "build", "--release", "--quiet", "-p", "gonio-trace", "--example", "rays"]
    subprocess.run(command, cwd=ROOT, check=True)
    return ROOT / "target" / "release" / "examples" / "rays"


def measured(command: list[str], folder: str) -> dict[str, float]:
    done = subprocess.run(
        command, capture_output=True, text=True, check=True, env=os.environ | {"RAYS_OUT": folder}
    )
    found: dict[str, float] = json.loads(done.stdout)
    return found


def run() -> list[dict[str, Any]]:
    ours = program()
    records = []
    for name, triangles in SIZES.items():
        with tempfile.TemporaryDirectory() as folder:
            pairs = [
                (
                    measured([str(ours), str(triangles)], folder),
                    measured([sys.executable, "-c", PEER, folder], folder),
                )
                for _ in range(PAIRS)
            ]
        lost = [(a["missed"] + a["lost"], b["primary_missed"] + b["bounce_missed"]) for a, b in pairs]
        records.append(
            {
                "id": name,
                "ours": statistics.median(a["bounce"] for a, _ in pairs),
                "peer": statistics.median(b["bounce"] for _, b in pairs),
                "peer_name": "Embree 4.4, robust",
                "ratio": statistics.median(a["bounce"] / b["bounce"] for a, b in pairs),
                "ratio_primary": statistics.median(a["primary"] / b["primary"] for a, b in pairs),
                "unit": "M rays/s",
                "bytes_per_triangle": pairs[0][0]["bytes_per_triangle"],
                "build_cpu_s": statistics.median(a["build_cpu_s"] for a, _ in pairs),
                "lost_ours": lost[0][0],
                "lost_peer": lost[0][1],
                "command": f"python -m bench {name}",
            }
        )
    return records
